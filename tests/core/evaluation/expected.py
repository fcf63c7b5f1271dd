#!/usr/bin/python3
"""Prints the figures that evo_rules_test.cpp expects, by a way of its own: numpy, 4 x 4 matrices, written from the
formulae of evo's documentation and papers (not from the C++ code). Needs Debian's python3-numpy; run by hand only."""
import numpy as np


def rot(axis, angle):
    c, s = np.cos(angle), np.sin(angle)
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    R = np.eye(3)
    R[i, i] = R[j, j] = c
    R[i, j], R[j, i] = -s, s
    return R


def pose(R, p):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, p
    return T


def angle(R):
    return np.arctan2(np.linalg.norm([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]), np.trace(R) - 1)


N = 40
ref, est = [], []
for i in range(N):
    p = np.array([3 * np.cos(0.2 * i), 2 * np.sin(0.3 * i), 0.1 * i])
    R = rot(2, 0.2 * i) @ rot(1, 0.1 * np.sin(i)) @ rot(0, 0.05 * np.cos(i))
    ref.append(pose(R, p))
    q = 1.02 * rot(2, 0.3) @ p + [1, 2, 3] + 0.05 * np.array([np.sin(5 * i), np.cos(7 * i), np.sin(3 * i)])
    est.append(pose(rot(2, 0.3) @ R @ rot(0, 0.02 * np.sin(2 * i)) @ rot(1, 0.02 * np.cos(3 * i)), q))


def positions(trajectory):
    return np.array([T[:3, 3] for T in trajectory])


def umeyama(x, y, with_scale):
    mx, my = x.mean(0), y.mean(0)
    sigma = np.mean([np.outer(b - my, a - mx) for a, b in zip(x, y)], axis=0)
    u, d, vt = np.linalg.svd(sigma)
    s = np.eye(3)
    if np.linalg.det(u) * np.linalg.det(vt) < 0:
        s[2, 2] = -1
    R = u @ s @ vt
    c = np.trace(np.diag(d) @ s) / np.mean(np.sum((x - mx) ** 2, axis=1)) if with_scale else 1.0
    return R, my - c * R @ mx, c


def posyaw(x, y):
    """By search instead of the closed form: golden section on the yaw angle."""
    mx, my = x.mean(0), y.mean(0)
    cost = lambda a: np.sum(((y - my) - (x - mx) @ rot(2, a).T) ** 2)
    a, b = -1.0, 1.0
    g = (np.sqrt(5) - 1) / 2
    for _ in range(200):
        c, d = b - g * (b - a), a + g * (b - a)
        a, b = (a, d) if cost(c) < cost(d) else (c, b)
    R = rot(2, 0.5 * (a + b))
    return R, my - R @ mx, 1.0


def apply(sim, trajectory):
    R, t, c = sim
    return [pose(R @ T[:3, :3], c * R @ T[:3, 3] + t) for T in trajectory]


def stats(name, e):
    e = np.array(e)
    print(f"{name:34s} n {len(e):3d} rmse {np.sqrt(np.mean(e**2)):.12f} mean {e.mean():.12f} median {np.median(e):.12f} "
          f"std {np.std(e):.12f} min {e.min():.12f} max {e.max():.12f} sse {np.sum(e**2):.12f}")


def ape(name, sim):
    a = apply(sim, est)
    stats(name + " translation", np.linalg.norm(positions(a) - positions(ref), axis=1))
    stats(name + " rotation", [angle(r[:3, :3].T @ t[:3, :3]) for r, t in zip(ref, a)])
    stats(name + " full", [np.linalg.norm(np.linalg.inv(r) @ t - np.eye(4)) for r, t in zip(ref, a)])


x, y = positions(est), positions(ref)
ape("none", (np.eye(3), np.zeros(3), 1.0))
ape("se3", umeyama(x, y, False))
ape("sim3", umeyama(x, y, True))
ape("se3 of 10", umeyama(x[:10], y[:10], False))
ape("posyaw", posyaw(x, y))
o = ref[0] @ np.linalg.inv(est[0])
ape("origin", (o[:3, :3], o[:3, 3], 1.0))


def metres(trajectory, delta, every):
    p = positions(trajectory)
    d = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1))])
    if every:
        pairs = []
        for i in range(len(p) - 1):
            off = np.abs(d[i + 1:] - d[i] - delta)
            j = int(np.argmin(off))
            if off[j] <= 0.1 * delta:
                pairs.append((i, i + 1 + j))
        return pairs
    ids, walked = [], 0.0
    for i in range(len(p)):
        walked += np.linalg.norm(p[i] - p[max(0, i - 1)])
        if walked >= delta:
            ids.append(i)
            walked = 0.0
    return list(zip(ids, ids[1:]))


def degrees(trajectory, delta, every):
    R = [T[:3, :3] for T in trajectory]
    delta = np.deg2rad(delta)
    if every:
        return [(i, j) for i in range(N) for j in range(i + 1, N) if 0.9 * delta <= angle(R[i].T @ R[j]) <= 1.1 * delta]
    pairs, start, turned = [], 0, 0.0
    for i in range(1, N):
        turned += angle(R[i - 1].T @ R[i])
        if turned >= delta:
            pairs.append((start, i))
            start, turned = i, 0.0
    return pairs


def rpe(name, pairs):
    E = [np.linalg.inv(np.linalg.inv(ref[i]) @ ref[j]) @ (np.linalg.inv(est[i]) @ est[j]) for i, j in pairs]
    stats(name + " translation", [np.linalg.norm(e[:3, 3]) for e in E])
    stats(name + " rotation", [angle(e[:3, :3]) for e in E])
    print("   pairs", pairs[:6])


rpe("1 frame", [(i, i + 1) for i in range(N - 1)])
rpe("3 frames consecutive", [(i, i + 3) for i in range(0, N - 3, 3)])
rpe("3 frames all", [(i, i + 3) for i in range(N - 3)])
rpe("2 m consecutive", metres(est, 2.0, False))
rpe("2 m consecutive, reference", metres(ref, 2.0, False))
rpe("2 m all", metres(est, 2.0, True))
rpe("30 deg consecutive", degrees(est, 30.0, False))
rpe("30 deg all", degrees(est, 30.0, True))

# A long drive for the segments of the KITTI devkit: 1.25 m a pose, slowly turning, the estimate 1 % too long.
ref, est = [], []
for i in range(400):
    R = rot(2, 0.002 * i)
    p = np.array([1.25 * i, 40 * np.sin(0.01 * i), 0])
    ref.append(pose(R, p))
    est.append(pose(rot(2, 0.0021 * i) @ rot(1, 0.001 * np.sin(0.1 * i)), 1.01 * p))
d = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(positions(ref), axis=0), axis=1))])
t, r = [], []
for first in range(0, 400, 10):
    for length in range(100, 900, 100):
        beyond = np.nonzero(d[first:] > d[first] + length)[0]
        if len(beyond) == 0:
            continue
        last = first + beyond[0]
        E = np.linalg.inv(np.linalg.inv(est[first]) @ est[last]) @ (np.linalg.inv(ref[first]) @ ref[last])
        t.append(np.linalg.norm(E[:3, 3]) / length)
        r.append(np.arccos(np.clip((np.trace(E[:3, :3]) - 1) / 2, -1, 1)) / length)
print(f"kitti n {len(t)} t {np.mean(t):.15f} r {np.mean(r):.15f}")
