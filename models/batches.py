"""Batches for training, each made from its number alone, so that a run that was cut off goes on as if it had not been."""
import torch

import targets
import warps
from photometric import seen_by_a_camera

PLACES_A_PAIR = 64
ANYWHERE = 16  # of these, not at key points


class Group:
    """Examples of one kind, on the training device: images padded to one size, points and segments to one number with NaN."""

    def __init__(self, examples, device, exact=False):
        self.exact = exact  # whether the points are the truth
        images, points, segments = zip(*examples)
        self.images = _stacked(images, 0).to(device)
        self.sizes = torch.tensor([[image.shape[1], image.shape[0]] for image in images], dtype=torch.float32, device=device)
        self.points, self.segments = (_stacked(lists, torch.nan).float().to(device) for lists in (points, segments))

    def drawn(self, g, count):
        which = torch.randint(len(self.images), (count,), generator=g, device=g.device)
        return self.images[which, None].float() / 255, self.sizes[which], self.points[which], self.segments[which]


def _stacked(arrays, fill):
    shape = [max(lengths) for lengths in zip(*(array.shape for array in arrays))]
    stack = torch.full((len(arrays), *shape), fill, dtype=torch.from_numpy(arrays[0]).dtype)
    for row, array in zip(stack, arrays):
        row[tuple(slice(length) for length in array.shape)] = torch.from_numpy(array)
    return stack


class Batches:
    """Batch n: `pairs` pairs of crops of one source image each, under a random move and two random gain controls. groups: pairs of
    a share and a Group."""

    def __init__(self, groups, seed, pairs, size, device):
        self.groups, self.seed, self.pairs, self.size = groups, seed, pairs, size
        self.generator = torch.Generator(device)

    def __getitem__(self, number):
        g = self.generator.manual_seed((self.seed << 32) + number)
        ends = [round(sum(share for share, _ in self.groups[:i]) * self.pairs) for i in range(len(self.groups) + 1)]
        parts = [self._pairs(g, group, end - start) for (_, group), start, end in zip(self.groups, ends, ends[1:]) if end > start]
        batch = {key: torch.cat([part[key] for part in parts]) for key in parts[0]}
        # First one view of every pair, then the other.
        for key in ("image", "shown", "labels", "field", "weights"):
            batch[key] = torch.cat([batch.pop(key + "_a"), batch.pop(key + "_b")])
        batch["image"] = seen_by_a_camera(g, batch["image"])
        return _without_the_blank(batch)

    def _pairs(self, g, group, count):
        images, sizes, points, segments = group.drawn(g, count)
        to_a = warps.random_crop(g, sizes, self.size)
        a_to_b = warps.random_motion(g, count, self.size)
        a, points_a = self._crop("_a", images, sizes, points, segments, to_a)
        b, _ = self._crop("_b", images, sizes, points, segments, a_to_b @ to_a)
        at_a = self._places(g, points_a)
        at_b = warps.carried(a_to_b, at_a)
        known = warps.inside(at_b, self.size, self.size, 4.0) & _shows(a["shown_a"], at_a) & _shows(b["shown_b"], at_b)
        return {**a, **b, "at_a": at_a, "at_b": at_b, "known": known, "a_to_b": a_to_b,
                "exact": torch.full((count,), group.exact, device=known.device)}

    def _crop(self, side, images, sizes, points, segments, homography):
        crop, shown = warps.warped(images, homography, self.size, sizes)
        here = warps.carried(homography, points)
        field, weights = targets.line_field(warps.carried_segments(homography, segments), shown)
        sides = {"image": crop, "shown": shown, "labels": targets.point_labels(here, shown), "field": field, "weights": weights}
        return {key + side: value for key, value in sides.items()}, here

    def _places(self, g, points):
        """Key points first, as far as there are any, and some places anywhere."""
        count = len(points)
        anywhere = warps.uniform(g, (count, PLACES_A_PAIR, 2), 4, self.size - 5)
        order = warps.inside(points, self.size, self.size, 4.0) * (1 + warps.uniform(g, points.shape[:2], 0, 1))
        best, which = order.topk(min(PLACES_A_PAIR - ANYWHERE, points.shape[1]), dim=1)
        chosen = torch.gather(points, 1, which[..., None].expand(-1, -1, 2))
        chosen = torch.where(best[..., None] > 0, chosen, anywhere[:, : which.shape[1]])
        return torch.cat([chosen, anywhere[:, which.shape[1] :]], 1)


def _without_the_blank(batch):
    """Nothing is to be found where the gain control left nothing to see."""
    seen = targets.shows_something(batch["image"])
    every = lambda stride: seen[:, stride // 2 :: stride, stride // 2 :: stride]
    batch["labels"] = torch.where(every(8) | (batch["labels"] < 0), batch["labels"], 64)
    batch["field"] = batch["field"] * every(4)[:, None]
    batch["weights"][:, 1] *= every(4)
    seen_a, seen_b = seen.chunk(2)
    batch["known"] &= _shows(seen_a, batch["at_a"]) & _shows(seen_b, batch["at_b"])
    return batch


def _shows(shown, at):
    height, width = shown.shape[1:]
    x, y = at[..., 0].round().clamp(0, width - 1).long(), at[..., 1].round().clamp(0, height - 1).long()
    return torch.gather(shown.flatten(1), 1, y * width + x)
