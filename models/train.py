"""Trains the point-line network and writes its weights: python3 models/train.py --work FOLDER [--frames FOLDER] [--threads N]

Stages, each kept in FOLDER as it goes; a run that was cut off goes on where it stopped.
  data    drawn scenes, labelled stills of HIT-UAV and of the simulator (see models/README.md)
  shapes  all heads on drawn scenes, whose truth is exact
  joint   all heads on drawn scenes and stills
  settle  all heads, simulated thermal images too
  lines   the line branch alone on thermal images, everything else frozen (the paper's second step)
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
from batches import Batches
from pl_net import LINE_MODULES, POINT_MODULES, PlNet

HERE = pathlib.Path(__file__).resolve().parent
STILLS = HERE.parent.parent / "shared/data/thermal/hit_uav"
SEED = 20260
STAGES = {
    # `schedule`: steps over which the learning rate rises and falls; `pairs` pairs of crops of `size` px a step; then the
    # weights of the groups of images.
    "shapes": dict(steps=241, schedule=600, rate=3e-3, pairs=6, size=192, shapes=1.0),
    "joint": dict(steps=1000, schedule=1000, rate=3e-3, pairs=4, size=160, shapes=0.45, hit_uav=0.55),
    "settle": dict(steps=300, schedule=300, rate=1.5e-3, pairs=4, size=192, shapes=0.35, hit_uav=0.4, simulated=0.25),
    "lines": dict(steps=200, schedule=200, rate=1e-3, pairs=2, size=192, shapes=0.3, hit_uav=0.3, simulated=0.4),
}


def make_data(work):
    sources.make_shapes(work / "shapes", 900, SEED)
    sources.label(work / "hit_uav", sources.hit_uav(STILLS)[:146], SEED + 1, every=2)
    sources.simulate(work / "frames", str(HERE.parent / "pllit"))
    sources.label_simulated(work / "simulated", work / "frames", SEED + 2)


def examples(work, stage):
    names = ("shapes", "hit_uav", "simulated")
    return sources.Sources([(stage[name], sources.all_in(work / name)) for name in names if name in stage])


def loss_of(net, batch, lines_only):
    with torch.autocast("cpu", torch.bfloat16):
        points, descriptors, lines = net(batch["image"].contiguous(memory_format=torch.channels_last))
    parts = losses.line_losses(lines, batch["field"], batch["weights"])
    if not lines_only:
        pairs = len(batch["image"]) // 2
        parts["points"] = losses.point_loss(points, batch["labels"])
        parts["descriptors"] = losses.descriptor_loss(
            descriptors[:pairs], descriptors[pairs:], batch["at_a"], batch["at_b"], batch["pair"])
    return parts


def optimiser_for(net, stage, lines_only):
    """Freezes what a stage does not train, its running means too."""
    for name in POINT_MODULES if lines_only else ():
        getattr(net, name).requires_grad_(False)
    chosen = [parameter for parameter in net.parameters() if parameter.requires_grad]
    optimiser = torch.optim.AdamW(chosen, stage["rate"], weight_decay=1e-4)
    schedule = torch.optim.lr_scheduler.OneCycleLR(
        optimiser, stage["rate"], total_steps=stage["schedule"] + 1, pct_start=0.08, div_factor=10, final_div_factor=100)
    return optimiser, schedule


def into_training(net, lines_only):
    net.train()
    for name in POINT_MODULES if lines_only else ():
        getattr(net, name).eval()


def run_stage(name, work, net, minutes_between_saves=3.0):
    stage, lines_only = STAGES[name], name == "lines"
    optimiser, schedule = optimiser_for(net, stage, lines_only)
    kept = work / f"{name}.pt"
    first = 0
    if kept.exists():
        state = torch.load(kept, weights_only=True)
        net.load_state_dict(state["net"]), optimiser.load_state_dict(state["optimiser"])
        schedule.load_state_dict(state["schedule"])
        first = state["step"]
    if first >= stage["steps"]:
        return
    batches = Batches(examples(work, stage), SEED + 10 + lines_only, stage["pairs"], stage["size"])
    loader = torch.utils.data.DataLoader(batches, batch_size=None, sampler=range(first, stage["steps"]), num_workers=1)
    into_training(net, lines_only)
    saved, sums, since = time.monotonic(), {}, time.monotonic()
    for step, batch in enumerate(loader, first + 1):
        parts = loss_of(net, batch, lines_only)
        optimiser.zero_grad()
        sum(parts.values()).backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), 5.0)
        optimiser.step()
        schedule.step()
        for part, value in parts.items():
            sums[part] = sums.get(part, 0.0) + value.item()
        if step % 25 == 0:
            shown = "  ".join(f"{part} {value / 25:.3f}" for part, value in sums.items())
            print(f"{name} {step}/{stage['steps']}  {shown}  {(time.monotonic() - since) / 25:.2f} s", flush=True)
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
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--only", choices=["data", *STAGES], help="stop after this stage")
    arguments = parser.parse_args()
    torch.manual_seed(SEED)
    torch.set_num_threads(arguments.threads)
    make_data(arguments.work)
    net = PlNet().to(memory_format=torch.channels_last)
    for name in STAGES if arguments.only != "data" else ():
        run_stage(name, arguments.work, net)
        if arguments.only == name:
            return
    if not arguments.only:  # in a process of its own: see export.py
        subprocess.run([sys.executable, str(HERE / "export.py"), str(arguments.work / "lines.pt"), str(HERE / "pl_net.onnx")], check=True)


if __name__ == "__main__":
    main()
