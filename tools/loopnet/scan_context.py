"""Scan Context: greatest heights in 20 rings x 60 sectors, compared column by column at the best shift.

Source: Kim and Kim, IROS 2018, Eq. (6) to (8); all pairs at all shifts, without the ring key's shortlist."""

import numpy as np

SECTORS = 60


def compare(contexts):
    """Score (1 - distance), yaw (rad) and score again of all pairs. contexts: N x 20 x 60."""
    norm = np.linalg.norm(contexts, axis=1, keepdims=True)
    columns = np.where(norm > 0, contexts / np.maximum(norm, 1e-9), 0.0)
    occupied = (norm[:, 0] > 0).astype(np.float32)
    spectrum, mask = np.fft.rfft(columns, axis=2), np.fft.rfft(occupied, axis=1)
    score, yaw = np.zeros((len(contexts),) * 2), np.zeros((len(contexts),) * 2)
    for a in range(len(contexts)):
        # sums over columns j of a[j + shift] b[j], and how many pairs of columns are both occupied
        product = np.fft.irfft((spectrum[a][None] * spectrum.conj()).sum(axis=1), n=SECTORS, axis=1)
        both = np.maximum(np.fft.irfft(mask[a][None] * mask.conj(), n=SECTORS, axis=1), 1e-3)
        cosine = np.where(both > 0.5, product / both, 0.0)
        best = cosine.argmax(axis=1)
        score[a] = cosine[np.arange(len(cosine)), best]
        yaw[a] = best * 2.0 * np.pi / SECTORS
    return score, (yaw + np.pi) % (2.0 * np.pi) - np.pi, score
