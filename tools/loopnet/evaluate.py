#!/usr/bin/python3
"""Measures Loop-Net, and Scan Context beside it, on worlds that it was not trained on; finds its threshold.

Pairs: all of two different visits to the same world. Positive: nearer than 5 m (indoors 2 m; of an Avia, with headings
within 40 degrees); negative: farther than 12 m (6 m); what lies between is left out. Of recordings also pairs of two, as
negatives."""

import argparse

import openblas

openblas.use()

import numpy as np
import torch

import export
import places
import scan_context

RETRIEVED = 20   # candidates of the global descriptor that the heads look at, as in the daemon


def loop_net_world(model, images):
    """Logits, yaws (rad) and similarities of all pairs of a world."""
    with torch.no_grad():
        parts = [model.backbone(torch.from_numpy(images[i:i + 64])) for i in range(0, len(images), 64)]
        seen = torch.cat([p[0] for p in parts]), torch.cat([p[1] for p in parts])
        rows = [model.heads((seen[0][i:i + 32], seen[1][i:i + 32]), seen) for i in range(0, len(images), 32)]
    join = lambda name: torch.cat([row[name] for row in rows]).numpy()
    return join("logit"), places.wrapped(join("shift") * places.BIN_RAD), join("similarity")


def area_under(score, positive, weight):
    """Area under the ROC curve."""
    order = np.argsort(-score)
    p, w = positive[order], weight[order]
    hits, misses = np.cumsum(p * w), np.cumsum(~p * w)
    return np.trapz(hits / hits[-1], misses / misses[-1])


def best_f1(score, positive, weight):
    order = np.argsort(-score)
    p, w = positive[order], weight[order]
    hits, misses = np.cumsum(p * w), np.cumsum(~p * w)
    precision, recall = hits / (hits + misses), hits / hits[-1]
    return np.max(2.0 * precision * recall / np.maximum(precision + recall, 1e-9))


class Tally:
    """Scores of many worlds, and what follows from them."""

    def __init__(self):
        self.score, self.positive, self.yaw_error, self.top, self.reverse_top = [], [], [], [], []

    def add(self, logit, yaw, similarity, positive, negative, turn, reverse):
        labelled = positive | negative
        np.fill_diagonal(labelled, False)
        self.score.append(logit[labelled])
        self.positive.append(positive[labelled])
        self.yaw_error.append(np.abs(places.wrapped(yaw - turn))[positive])
        for query in np.flatnonzero(positive.any(axis=1)):
            others = np.flatnonzero(np.arange(len(logit)) != query)
            near = others[np.argsort(-similarity[query, others])[:RETRIEVED]]
            best = near[np.argmax(logit[query, near])]
            self.top.append(positive[query, best])
            # Revisits the other way round alone: all that was seen in about the same direction is taken away.
            back = others[reverse[query, others] | ~(positive[query, others])]
            if positive[query, back].any():
                near = back[np.argsort(-similarity[query, back])[:RETRIEVED]]
                self.reverse_top.append(positive[query, near[np.argmax(logit[query, near])]])

    def row(self, threshold):
        score, positive = np.concatenate(self.score), np.concatenate(self.positive)
        yaw = np.rad2deg(np.concatenate(self.yaw_error))
        even = np.ones(len(score))
        balanced = np.where(positive, 1.0 / max(positive.sum(), 1), 1.0 / max((~positive).sum(), 1))
        part = lambda values: np.mean(values) if len(values) else float("nan")
        return (f"{len(score):8d} | {area_under(score, positive, even):.4f} | {best_f1(score, positive, balanced):.3f} | "
                f"{best_f1(score, positive, even):.3f} | {part(self.top):.3f} | {part(self.reverse_top):.3f} | "
                f"{np.median(yaw):.2f} / {np.quantile(yaw, 0.9):.1f} | {np.mean(yaw < 5.0):.3f} | "
                f"{np.mean(score[~positive] > threshold):.4f} | {np.mean(score[positive] > threshold):.3f}")


HEAD = ("| set | pairs | AUC | F1 balanced | F1 natural | R@1 | R@1 reverse | yaw median / p90 | < 5 deg | false positives "
        "| true positives |\n|---|---|---|---|---|---|---|---|---|---|---|")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--places", nargs="+", required=True)
    parser.add_argument("--checkpoint", help="of train.py")
    parser.add_argument("--threshold", type=float, default=0.0)
    parser.add_argument("--calibrate", type=float, metavar="SHARE",
                        help="print the threshold at which this share of the negatives of each set, at most, passes")
    parser.add_argument("--scan-context", action="store_true", help="measure Scan Context on the same pairs")
    parser.add_argument("--threads", type=int, default=1)
    options = parser.parse_args()
    torch.set_num_threads(options.threads)
    model = export.load(options.checkpoint)[0] if options.checkpoint else None
    thresholds = []
    print(HEAD)
    for folder in options.places:
        data = places.Places(folder)
        methods = (["Loop-Net"] if model else []) + (["Scan Context"] if options.scan_context else [])
        for method in methods:
            tallies = {"all": Tally()}
            recorded = data.kind[0] < 0   # other recordings are other places
            for rows in [np.arange(len(data))] if recorded else data.by_world:
                kind = places.KINDS[data.kind[rows[0]]]
                positive, negative, turn = places.labels(
                    data.world[rows], data.position[rows], data.yaw[rows], data.indoor[rows], data.sensor[rows])
                if method == "Loop-Net":
                    logit, yaw, similarity = loop_net_world(model, data.images[rows])
                else:
                    logit, yaw, similarity = scan_context.compare(data.contexts(rows))
                reverse = np.abs(turn) > np.deg2rad(90.0)
                for name in ("all", kind):
                    tallies.setdefault(name, Tally()).add(logit, yaw, similarity, positive, negative, turn, reverse)
            for name, tally in tallies.items():
                if name == "all" or not recorded:
                    print(f"| {method}: {folder}, {name} | {tally.row(options.threshold)} |", flush=True)
            if options.calibrate is not None and method == "Loop-Net":
                all_pairs = tallies["all"]
                scores = np.concatenate(all_pairs.score)[~np.concatenate(all_pairs.positive)]
                thresholds.append(np.quantile(scores, 1.0 - options.calibrate))
    if thresholds:
        print(f"threshold {max(thresholds):.3f} (of each set: {', '.join(f'{t:.3f}' for t in thresholds)})")


if __name__ == "__main__":
    main()
