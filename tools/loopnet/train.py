#!/usr/bin/python3
"""Trains Loop-Net on what make_places wrote. Seeded; goes on where it stopped when run again with the same --out."""

import argparse
import json
import math
import os
import pathlib
import sys
import time

import openblas

openblas.use()

import numpy as np
import torch
from torch.nn import functional as F

import model as net
import places

def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--places", nargs="+", required=True, help="folders of make_places to learn from")
    parser.add_argument("--out", required=True, help="folder for the checkpoint, the log and the curve")
    parser.add_argument("--iterations", type=int, default=4000)
    parser.add_argument("--worlds", type=int, default=4, help="of a batch")
    parser.add_argument("--visits", type=int, default=16, help="of each of them")
    parser.add_argument("--rate", type=float, default=2e-3, help="greatest learning rate")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--save-every", type=int, default=100)
    return parser.parse_args()


def batch(joined, options, rng):
    """Rows of some worlds: a few places of each, all their visits."""
    images, columns = [], {name: [] for name in ("world", "position", "yaw", "indoor", "sensor")}
    for number in range(options.worlds):
        data, rows = joined.worlds[rng.integers(len(joined.worlds))]
        order = rng.permutation(np.unique(data.place[rows]))
        chosen = np.concatenate([rows[data.place[rows] == place] for place in order[:options.visits]])[:options.visits]
        for row in chosen:
            images.append(data.images[row])
        columns["world"].append(np.full(len(chosen), number))
        for name in ("position", "yaw", "indoor", "sensor"):
            columns[name].append(getattr(data, name)[chosen])
    return np.stack(images), {name: np.concatenate(values) for name, values in columns.items()}


def changed(images, yaw, rng):
    """Turns each image by whole bins, mirrors the batch or not, and hides cells and sectors."""
    images = images.copy()
    yaw = yaw.copy()
    mirror = rng.random() < 0.5
    for i in range(len(images)):
        turn = int(rng.integers(120))
        image = np.roll(images[i], turn, axis=2)
        yaw[i] -= turn * np.deg2rad(3.0)
        if rng.random() < 0.4:
            image = image * (rng.random(image.shape) > rng.uniform(0.02, 0.2))
        if rng.random() < 0.3:
            width, ring = int(rng.integers(2, 16)), int(rng.integers(0, 30))
            hidden = (int(rng.integers(120)) + np.arange(width)) % 120
            image = image.copy()
            image[:, ring:, hidden] = 0
        images[i] = image[:, :, ::-1] if mirror else image
    return images, -yaw if mirror else yaw


def losses(model, images, rows):
    """The three tasks' losses on all pairs of a batch."""
    images, yaw = images
    positive, negative, _ = places.labels(rows["world"], rows["position"], rows["yaw"], rows["indoor"], rows["sensor"])
    turn = places.wrapped(yaw[None] - yaw[:, None])
    positive, negative = torch.from_numpy(positive), torch.from_numpy(negative)
    same = torch.from_numpy(rows["world"][:, None] == rows["world"][None])
    seen = model.backbone(torch.from_numpy(images))
    pair = model.heads(seen, seen)
    logit = pair["logit"]

    # classification: positives, all negatives, and the hardest tenth of those of the same world
    hard = F.softplus(logit[negative & same])
    easy = F.softplus(logit[negative & ~same])
    worst = hard.topk(max(1, len(hard) // 10)).values if len(hard) else easy
    overlap = F.softplus(-logit[positive]).mean() + 0.5 * hard.mean() + 0.25 * easy.mean() + 0.5 * worst.mean()

    # regression: the correlation is the yaw's distribution, and its parabola's vertex the yaw
    target = torch.from_numpy(turn / places.BIN_RAD).float()[positive]
    shifts = torch.arange(net.COLUMNS).float()
    apart = (shifts[None] - target[:, None] + 0.5 * net.COLUMNS) % net.COLUMNS - 0.5 * net.COLUMNS
    wanted = torch.softmax(-0.5 * (apart / 0.7).square(), dim=1)
    found = torch.log_softmax(model.heads.log_sharpness.exp() * pair["correlation"][positive], dim=1)
    distribution = -(wanted * found).sum(dim=1).mean()
    off = (pair["shift"][positive] - target + 0.5 * net.COLUMNS) % net.COLUMNS - 0.5 * net.COLUMNS
    vertex = off.abs()[off.abs() < 1.5]
    vertex = vertex.mean() if len(vertex) else off.sum() * 0.0

    # retrieval: each positive against all negatives of its row
    similarity = model.heads.log_temperature.exp() * pair["similarity"]
    others = similarity.masked_fill(~negative, -1e9).logsumexp(dim=1, keepdim=True)
    retrieval = F.softplus(others - similarity)[positive].mean()
    return overlap, distribution, vertex, retrieval


def rate_at(iteration, options):
    warm = min(1.0, (iteration + 1) / 100)
    return options.rate * warm * (0.01 + 0.99 * 0.5 * (1.0 + math.cos(math.pi * iteration / options.iterations)))


class Averaged:
    """A slow average of the weights: what is exported."""

    def __init__(self, model):
        self.state = {name: value.clone() for name, value in model.state_dict().items()}

    def follow(self, model, iteration):
        keep = min(0.998, (iteration + 1) / (iteration + 10))
        for name, value in model.state_dict().items():
            if value.dtype.is_floating_point:
                self.state[name].mul_(keep).add_(value, alpha=1.0 - keep)
            else:
                self.state[name].copy_(value)


def plot(log, path):
    try:
        import matplotlib
        matplotlib.use("Agg")
        from matplotlib import pyplot
    except ImportError:
        return
    rows = [json.loads(line) for line in open(log)]
    figure, axes = pyplot.subplots(1, 4, figsize=(16, 3.5))
    for axis, name in zip(axes, ("overlap", "distribution", "vertex_deg", "retrieval")):
        axis.plot([row["iteration"] for row in rows], [row[name] for row in rows])
        axis.set(title=name, xlabel="iteration", yscale="log")
    figure.tight_layout()
    figure.savefig(path, dpi=80)
    pyplot.close(figure)


def main():
    options = arguments()
    torch.set_num_threads(options.threads)
    out = pathlib.Path(options.out)
    out.mkdir(parents=True, exist_ok=True)
    joined = places.Joined([places.Places(folder) for folder in options.places])
    torch.manual_seed(options.seed)
    model = net.LoopNet().to(memory_format=torch.channels_last)
    optimiser = torch.optim.AdamW(model.parameters(), lr=options.rate, weight_decay=1e-4)
    averaged = Averaged(model)
    begin, checkpoint = 0, out / "checkpoint.pt"
    if checkpoint.exists():
        saved = torch.load(checkpoint)
        model.load_state_dict(saved["model"])
        optimiser.load_state_dict(saved["optimiser"])
        averaged.state = saved["averaged"]
        begin = saved["iteration"]
    print(f"{len(joined)} visits of {len(joined.worlds)} worlds, "
          f"{sum(p.numel() for p in model.parameters())} parameters, from iteration {begin}", flush=True)

    def save(iteration):
        torch.save({"model": model.state_dict(), "optimiser": optimiser.state_dict(), "averaged": averaged.state,
                    "iteration": iteration, "command": " ".join(["tools/loopnet/train.py"] + sys.argv[1:])},
                   out / "checkpoint.new")
        os.replace(out / "checkpoint.new", checkpoint)
        plot(out / "log.jsonl", out / "curve.png")

    sums, counted, clock = np.zeros(4), 0, time.monotonic()
    for iteration in range(begin, options.iterations):
        rng = np.random.default_rng([options.seed, iteration])
        images, rows = batch(joined, options, rng)
        model.train()
        parts = losses(model, changed(images, rows["yaw"], rng), rows)
        overlap, distribution, vertex, retrieval = parts
        for group in optimiser.param_groups:
            group["lr"] = rate_at(iteration, options)
        optimiser.zero_grad()
        (overlap + distribution + vertex + 0.5 * retrieval).backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), 2.0)
        optimiser.step()
        averaged.follow(model, iteration)
        sums += [float(part) for part in parts]
        counted += 1
        if (iteration + 1) % 20 == 0:
            mean = sums / counted
            row = {"iteration": iteration + 1, "overlap": mean[0], "distribution": mean[1], "vertex_deg": 6.0 * mean[2],
                   "retrieval": mean[3], "s": (time.monotonic() - clock) / counted}
            with open(out / "log.jsonl", "a") as log:
                log.write(json.dumps(row) + "\n")
            left = row["s"] * (options.iterations - iteration - 1) / 60
            print(f"{iteration + 1}/{options.iterations} overlap {mean[0]:.3f} yaw {mean[1]:.3f} "
                  f"{6.0 * mean[2]:.2f} deg retrieval {mean[3]:.3f} {row['s']:.2f} s, {left:.0f} min left", flush=True)
            sums, counted, clock = np.zeros(4), 0, time.monotonic()
        if (iteration + 1) % options.save_every == 0 or iteration + 1 == options.iterations:
            save(iteration + 1)


if __name__ == "__main__":
    main()
