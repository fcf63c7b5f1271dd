#!/usr/bin/python3
"""Writes Loop-Net's trained weights as the daemon links them, and vectors that its C++ is held against.

The file: "slamdLN1", the number of floats (uint32), the floats, CRC-32 of all before; little-endian. Batch norms are folded
into the layers before them; the threshold is folded into the last bias, so that a logit above 0 means overlap."""

import argparse
import hashlib
import pathlib
import struct
import sys
import zlib

import numpy as np
import torch

import model as net
import places


def folded(weight, norm):
    """Weights and bias of a layer without bias and the batch norm behind it."""
    scale = norm.weight / torch.sqrt(norm.running_var + norm.eps)
    return weight * scale.view(-1, *[1] * (weight.dim() - 1)), norm.bias - norm.running_mean * scale


def taps_first(weight):
    """Channels last: the order in which tap_product reads."""
    return weight.reshape(weight.shape[0], -1).T


def floats_of(model, threshold):
    parts = []
    for layer in model.backbone.convs:
        weight, bias = folded(layer.conv.weight, layer.norm)
        parts += [taps_first(weight), bias]
    for conv, norm in ((model.backbone.column, model.backbone.column_norm), (None, None),
                       (model.backbone.wide, model.backbone.wide_norm)):
        if conv is None:
            parts += [taps_first(model.backbone.context.weight), model.backbone.context.bias]
        else:
            weight, bias = folded(conv.weight, norm)
            parts += [taps_first(weight), bias]
    heads = model.heads
    parts += [model.backbone.describe.weight, model.backbone.describe.bias, heads.sketch.weight,
              heads.hidden.weight, heads.hidden.bias, heads.overlap.weight, heads.overlap.bias - threshold]
    return np.concatenate([part.detach().numpy().astype("<f4").ravel() for part in parts])


def load(path):
    """The slowly averaged weights of a checkpoint, ready to be used."""
    saved = torch.load(path)
    model = net.LoopNet()
    model.load_state_dict(saved["averaged"])
    return model.eval(), saved


def vectors(model, threshold, data, rows):
    """Images, their descriptors and columns, and all pairs' logit, yaw and margin, as float32 behind one another."""
    images = np.stack([data.images[row] for row in rows])
    with torch.no_grad():
        seen = model.backbone(torch.from_numpy(images))
        pair = model.heads(seen, seen)
    yaw = places.wrapped(pair["shift"].numpy() * places.BIN_RAD)
    head = struct.pack("<I", len(rows)) + images.tobytes()
    return head + b"".join(np.ascontiguousarray(part).astype("<f4").tobytes() for part in (
        seen[1].numpy(), seen[0].numpy(), pair["logit"].numpy() - threshold, yaw, pair["margin"].numpy()))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--checkpoint", required=True)
    parser.add_argument("--threshold", type=float, default=0.0, help="logit that evaluate.py --calibrate found")
    parser.add_argument("--weights", default="core/loop/weights/loop_net.bin")
    parser.add_argument("--vectors", help="where to write vectors for the test")
    parser.add_argument("--places", help="folder of make_places whose first images the vectors take")
    options = parser.parse_args()
    model, saved = load(options.checkpoint)
    floats = floats_of(model, options.threshold)
    body = b"slamdLN1" + struct.pack("<I", len(floats)) + floats.tobytes()
    weights = body + struct.pack("<I", zlib.crc32(body))
    path = pathlib.Path(options.weights)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(weights)
    digest = hashlib.sha256(weights).hexdigest()
    path.with_suffix(".sha256").write_text(f"{digest}  {path.name}\n")
    path.with_suffix(".txt").write_text(
        f"{saved['command']}\n(stopped at iteration {saved['iteration']})\n"
        f"tools/loopnet/export.py {' '.join(sys.argv[1:])}\n")
    print(f"{len(floats)} floats, {len(weights)} bytes, {digest}")
    if options.vectors:
        data = places.Places(options.places)
        pathlib.Path(options.vectors).write_bytes(vectors(model, options.threshold, data, [0, 1, 2, 3, 4, 5]))


if __name__ == "__main__":
    main()
