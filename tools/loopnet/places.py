"""Places as make_places writes them, and pairs of them with their labels."""

import pathlib

import numpy as np

OUTDOOR = (5.0, 12.0)   # positive below, negative above; m
INDOOR = (2.0, 6.0)
AVIA = 1
AVIA_OVERLAP_RAD = np.deg2rad(40.0)   # headings farther apart see different things
BIN_RAD = np.deg2rad(6.0)
KINDS = ("streets", "grounds", "floors", "town", "campus", "indoor", "warehouse", "harbour", "recording")


class Places:
    """images: N x 8 x 40 x 120 bytes, mapped. The rest: N numbers."""

    def __init__(self, folder):
        folder = pathlib.Path(folder)
        self.images = np.load(folder / "images.npy", mmap_mode="r")
        rows = np.load(folder / "visits.npy")
        self.world, self.place, self.kind, self.sensor = (rows[:, i].astype(int) for i in range(4))
        self.indoor = rows[:, 4] > 0.5
        self.position, self.yaw = rows[:, 5:8], rows[:, 8]
        self.folder = folder
        self.by_world = [np.flatnonzero(self.world == w) for w in np.unique(self.world)]

    def __len__(self):
        return len(self.world)

    def contexts(self, rows):
        return np.load(self.folder / "contexts.npy", mmap_mode="r")[rows]


class Joined:
    """Several sets as one; worlds stay apart."""

    def __init__(self, sets):
        self.sets = sets
        self.worlds = [(s, rows) for s in sets for rows in s.by_world]

    def __len__(self):
        return sum(len(s) for s in self.sets)


def wrapped(angle):
    return (angle + np.pi) % (2.0 * np.pi) - np.pi


def labels(world, position, yaw, indoor, sensor):
    """All against all: positive, negative (neither: left out), yaw of b in a (rad).

    Rows of different worlds are negatives; a row and itself are left out."""
    same = world[:, None] == world[None]
    distance = np.linalg.norm(position[:, None, :2] - position[None, :, :2], axis=2)
    near = np.where(indoor, INDOOR[0], OUTDOOR[0])[:, None]
    far = np.where(indoor, INDOOR[1], OUTDOOR[1])[:, None]
    turn = wrapped(yaw[None] - yaw[:, None])
    sees = (sensor != AVIA)[:, None] | (np.abs(turn) < AVIA_OVERLAP_RAD)
    positive = same & (distance < near) & sees
    np.fill_diagonal(positive, False)
    return positive, ~same | (distance > far), turn
