"""Trains the point-line network and writes its weights: python3 models/train.py --work FOLDER [--device cuda]

Stages, each kept in FOLDER as it goes; a run that was cut off goes on where it stopped.
  data    drawn scenes, labelled stills of HIT-UAV and of the simulator (see models/README.md)
  shapes  all heads on drawn scenes, whose truth is exact
  joint   all heads on drawn scenes and stills
  agree   the same; key points of stills are now what two views of a place agree on
  lines   the line branch alone on stills, everything else frozen (the paper's second step)
  export  models/pl_net.onnx
"""
import argparse
import pathlib
import subprocess
import sys
import time

import torch

import losses
import sources
import targets
from batches import Batches, Group
from pl_net import POINT_MODULES, PlNet

HERE = pathlib.Path(__file__).resolve().parent
STILLS = HERE.parent.parent / "shared/data/thermal/hit_uav"
SEED = 20260
PAIRS = {"cpu": 6, "cuda": 96}  # of crops, a step
SIZE_PX = 192
STAGES = {
    # Steps, over which the learning rate rises and falls again; shares of the groups of images.
    "shapes": dict(steps=1000, rate=3e-3, shares={"shapes": 1.0}),
    "joint": dict(steps=2500, rate=3e-3, shares={"shapes": 0.3, "hit_uav": 0.3, "simulated": 0.4}),
    "agree": dict(steps=700, rate=1e-3, shares={"shapes": 0.2, "hit_uav": 0.4, "simulated": 0.4}),
    "lines": dict(steps=600, rate=2e-3, shares={"shapes": 0.2, "hit_uav": 0.25, "simulated": 0.55}),
}
SHOW_EVERY = 50


def make_data(work, processes):
    shapes = [(f"{i:05d}", SEED, i) for i in range(4000)]
    sources.make_all(work / "shapes", sources.shape, shapes, processes)
    if not (work / "labelled").exists():
        stills = [(path.stem, path, SEED + 1, i) for i, path in enumerate(sources.hit_uav(STILLS))]
        sources.make_all(work / "hit_uav", sources.still, stills, processes)
        frames = sources.simulate(work / "frames", str(HERE.parent / "pllit"))
        frames = [(f"{path.parent.name}_{path.name.split('.')[0]}", path, SEED + 2, i) for i, path in enumerate(frames)]
        sources.make_all(work / "simulated", sources.simulated_still, frames, processes)
        (work / "labelled").touch()


def groups(work, device):
    """On the device; images of one folder may differ in size."""
    return {name: Group(sources.all_in(work / name), device, exact=name == "shapes") for name in ("shapes", "hit_uav", "simulated")}


def loss_of(net, batch, name):
    images = batch["image"].contiguous(memory_format=torch.channels_last)
    with torch.autocast(images.device.type, torch.bfloat16, enabled=images.is_cuda):  # few processors are quick at it
        points, descriptors, lines = net(images)
    parts = losses.line_losses(lines, batch["field"], batch["weights"])
    if name != "lines":
        pairs = len(images) // 2
        labels = batch["labels"] if name != "agree" else agreed(points.detach(), batch)
        parts["points"] = losses.point_loss(points, labels)
        parts["descriptors"] = losses.descriptor_loss(
            descriptors[:pairs], descriptors[pairs:], batch["at_a"], batch["at_b"], batch["known"])
    return parts


def agreed(points, batch):
    """Labels of both views of each pair; where they were the truth they stay."""
    others = lambda stack: stack.roll(len(stack) // 2, 0)
    to_other = torch.cat([batch["a_to_b"], torch.linalg.inv(batch["a_to_b"])])
    labels = targets.agreed_labels(points, others(points), to_other, batch["shown"], others(batch["shown"]), batch["labels"])
    return torch.where(batch["exact"].repeat(2)[:, None, None], batch["labels"], labels)


def optimiser_for(net, stage, lines_only):
    """Freezes what a stage does not train."""
    for name in POINT_MODULES if lines_only else ():
        getattr(net, name).requires_grad_(False)
    chosen = [parameter for parameter in net.parameters() if parameter.requires_grad]
    optimiser = torch.optim.AdamW(chosen, stage["rate"], weight_decay=1e-4)
    schedule = torch.optim.lr_scheduler.OneCycleLR(
        optimiser, stage["rate"], total_steps=stage["steps"] + 1, pct_start=0.08, div_factor=10, final_div_factor=100)
    return optimiser, schedule


def into_training(net, lines_only):
    net.train()
    for name in POINT_MODULES if lines_only else ():  # their running means stay too
        getattr(net, name).eval()


def run_stage(name, work, net, batches, minutes_between_saves=3.0):
    stage, kept, first = STAGES[name], work / f"{name}.pt", 0
    optimiser, schedule = optimiser_for(net, stage, name == "lines")
    if kept.exists():
        state = torch.load(kept, weights_only=True)
        net.load_state_dict(state["net"]), optimiser.load_state_dict(state["optimiser"])
        schedule.load_state_dict(state["schedule"])
        first = state["step"]
    into_training(net, name == "lines")
    saved, since, sums = time.monotonic(), time.monotonic(), {}
    for step in range(first + 1, stage["steps"] + 1):
        parts = loss_of(net, batches[step], name)
        optimiser.zero_grad()
        sum(parts.values()).backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), 5.0)
        optimiser.step()
        schedule.step()
        for part, value in parts.items():
            sums[part] = sums.get(part, 0.0) + value.detach()
        if step % SHOW_EVERY == 0:
            shown = "  ".join(f"{part} {float(value) / SHOW_EVERY:.3f}" for part, value in sums.items())
            print(f"{name} {step}/{stage['steps']}  {shown}  {(time.monotonic() - since) / SHOW_EVERY:.3f} s", flush=True)
            sums, since = {}, time.monotonic()
        if step == stage["steps"] or time.monotonic() - saved > 60 * minutes_between_saves:
            partial = kept.with_suffix(".partial")
            torch.save({"net": net.state_dict(), "optimiser": optimiser.state_dict(), "schedule": schedule.state_dict(), "step": step},
                       partial)
            partial.rename(kept)
            saved = time.monotonic()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for data and checkpoints, some 300 MB")
    parser.add_argument("--device", choices=PAIRS, default="cpu")
    parser.add_argument("--threads", type=int, default=2, help="of the processor")
    parser.add_argument("--only", choices=["data", *STAGES], help="stop after this stage")
    arguments = parser.parse_args()
    torch.manual_seed(SEED)
    torch.set_num_threads(arguments.threads)
    torch.backends.cudnn.benchmark = True
    make_data(arguments.work, arguments.threads)
    if arguments.only == "data":
        return
    net = PlNet().to(arguments.device, memory_format=torch.channels_last)
    examples = groups(arguments.work, arguments.device)
    for number, (name, stage) in enumerate(STAGES.items()):
        mixed = [(share, examples[group]) for group, share in stage["shares"].items()]
        run_stage(name, arguments.work, net, Batches(mixed, SEED + 10 + number, PAIRS[arguments.device], SIZE_PX, arguments.device))
        if arguments.only == name:
            return
    # In a process of its own: see export.py.
    subprocess.run([sys.executable, str(HERE / "export.py"), str(arguments.work / "lines.pt"), str(HERE / "pl_net.onnx")], check=True)


if __name__ == "__main__":
    main()
