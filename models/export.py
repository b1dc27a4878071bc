"""Writes a checkpoint as ONNX, opset 17: python3 models/export.py CHECKPOINT OUT.onnx"""
import os
import sys

import torch

from pl_net import Exported, PlNet


def load_onnx_quietly():
    """Debian's onnx, loaded beside PyTorch, registers every operator twice and complains of each."""
    terminal, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 2)
    import onnx  # noqa: F401
    os.dup2(terminal, 2)


def main(checkpoint, out):
    load_onnx_quietly()
    net = PlNet()
    net.load_state_dict(torch.load(checkpoint, weights_only=True)["net"])
    names = ["scores", "descriptors", "lines"]
    sizes = {"image": {2: "height", 3: "width"}, "scores": {2: "height", 3: "width"}}
    sizes |= {"descriptors": {2: "height_8", 3: "width_8"}, "lines": {2: "height_4", 3: "width_4"}}
    torch.onnx.export(Exported(net).eval(), torch.rand(1, 1, 128, 160), out, opset_version=17, input_names=["image"],
                      output_names=names, dynamic_axes=sizes)


if __name__ == "__main__":
    main(*sys.argv[1:])
