"""Loop-Net's network: polar image -> columns and descriptor; pair of them -> overlap and relative yaw.

Shapes: B images; pairs are scored all against all, A x B. Azimuth is circular everywhere.
Yaw: of pair (a, b) the rotation about z that turns b's frame into a's: p_a = R_a_b p_b, so that what b sees at azimuth
phi stands at phi + yaw in a. Units: bins of 6 degrees here, radians in C++.
"""

import math

import torch
from torch import nn
from torch.nn import functional as F

COLUMNS = 60      # of 6 degrees
FEATURES = 64     # of a column
DESCRIPTOR = 128
GROUPS = 8        # of features, correlated each on its own for the classification head
SKETCH = 8        # products of projected descriptors, for the same
STATISTICS = 6    # of the correlation, and the descriptors' product
HIDDEN = 32
PEAK_BINS = 5     # around the peak that no second peak is looked for


def normalised_input(images):
    """Bytes of round(32 log2(1 + n)) as floats, divided by the mean of the cells that are not empty."""
    x = images.float() / 32.0
    occupied = (x > 0).sum(dim=(1, 2, 3)).clamp(min=1)
    mean = x.sum(dim=(1, 2, 3)) / occupied
    return x / mean.clamp(min=1.0 / 32.0)[:, None, None, None]


def wrapped(x, columns):
    """With the last columns before the first ones, and the first ones behind the last."""
    return torch.cat([x[..., -columns:], x, x[..., :columns]], dim=-1)


class CircularConv(nn.Module):
    """3 x 3 over rings (zeros beyond) and azimuths (circular), batch norm, ReLU."""

    def __init__(self, channels_in, channels_out, stride):
        super().__init__()
        self.conv = nn.Conv2d(channels_in, channels_out, 3, stride=stride, padding=(1, 0), bias=False)
        self.norm = nn.BatchNorm2d(channels_out)

    def forward(self, x):
        return F.relu(self.norm(self.conv(wrapped(x, 1))), inplace=True)


class Backbone(nn.Module):
    """Backbone A: a polar CNN. Gives columns B x 64 x 60 of norm 1 and descriptors B x 128 of norm 1."""

    def __init__(self):
        super().__init__()
        self.convs = nn.Sequential(
            CircularConv(8, 16, (2, 1)), CircularConv(16, 32, (2, 2)),
            CircularConv(32, 40, (1, 1)), CircularConv(40, 48, (2, 1)))
        self.column = nn.Conv2d(48, FEATURES, (5, 1), bias=False)
        self.column_norm = nn.BatchNorm1d(FEATURES)
        self.context = nn.Conv1d(FEATURES, FEATURES, 5)
        self.wide = nn.Conv1d(FEATURES, DESCRIPTOR, 3, bias=False)
        self.wide_norm = nn.BatchNorm1d(DESCRIPTOR)
        self.describe = nn.Linear(2 * DESCRIPTOR, DESCRIPTOR)

    def forward(self, images):
        x = normalised_input(images).contiguous(memory_format=torch.channels_last)
        x = self.convs(x)
        x = F.relu(self.column_norm(self.column(x).squeeze(2)))
        columns = self.context(wrapped(x, 2))
        columns = columns / columns.flatten(1).norm(dim=1).clamp(min=1e-6)[:, None, None]
        wide = F.relu(self.wide_norm(self.wide(wrapped(x, 1))))
        descriptor = self.describe(torch.cat([wide.mean(dim=2), wide.amax(dim=2)], dim=1))
        return columns, F.normalize(descriptor, dim=1, eps=1e-6)


def group_correlations(columns_a, columns_b):
    """A x B x groups x shifts: sum over columns j of a[j + shift] b[j], by group of features."""
    size = FEATURES // GROUPS
    spectrum_a = torch.fft.rfft(columns_a, dim=2).view(-1, GROUPS, size, COLUMNS // 2 + 1)
    spectrum_b = torch.fft.rfft(columns_b, dim=2).view(-1, GROUPS, size, COLUMNS // 2 + 1)
    left = spectrum_a.permute(1, 3, 0, 2)
    right = spectrum_b.permute(1, 3, 2, 0)
    # complex products of left and the conjugate of right as real ones: they are quicker here
    left = torch.cat([left.real, left.imag], dim=3)
    real = left @ torch.cat([right.real, right.imag], dim=2)
    imag = left @ torch.cat([-right.imag, right.real], dim=2)
    product = torch.complex(real, imag).permute(2, 3, 0, 1)
    return torch.fft.irfft(product, n=COLUMNS, dim=3)


def refined_peak(correlation):
    """Best shift and the parabola's vertex around it, in bins, both A x B."""
    best = correlation.argmax(dim=2)
    at = lambda offset: correlation.gather(2, ((best + offset) % COLUMNS)[..., None]).squeeze(2)
    before, peak, after = at(-1), at(0), at(1)
    curve = (before - 2.0 * peak + after).clamp(max=-1e-9)
    return best, best + (0.5 * (before - after) / curve).clamp(-0.5, 0.5), peak


def second_peak(correlation, best):
    """The greatest correlation farther than PEAK_BINS from the best shift."""
    shifts = torch.arange(COLUMNS)
    apart = (shifts - best[..., None]) % COLUMNS
    apart = torch.minimum(apart, COLUMNS - apart)
    return correlation.masked_fill(apart <= PEAK_BINS, -2.0).amax(dim=2)


class Heads(nn.Module):
    """Classification (overlap logit) and regression (shift in bins) for all pairs."""

    def __init__(self):
        super().__init__()
        self.sketch = nn.Linear(DESCRIPTOR, SKETCH, bias=False)
        self.hidden = nn.Linear(STATISTICS + GROUPS + SKETCH, HIDDEN)
        self.overlap = nn.Linear(HIDDEN, 1)
        self.log_sharpness = nn.Parameter(torch.tensor(math.log(40.0)))     # of the yaw's distribution
        self.log_temperature = nn.Parameter(torch.tensor(math.log(10.0)))   # of the descriptors' products

    def forward(self, a, b):
        (columns_a, descriptor_a), (columns_b, descriptor_b) = a, b
        groups = group_correlations(columns_a, columns_b)
        correlation = groups.sum(dim=2)
        best, shift, peak = refined_peak(correlation)
        second = second_peak(correlation, best)
        similarity = descriptor_a @ descriptor_b.T
        at_best = groups.gather(3, best[..., None, None].expand(-1, -1, GROUPS, 1)).squeeze(3)
        sketch = self.sketch(descriptor_a)[:, None] * self.sketch(descriptor_b)[None]
        mean = correlation.mean(dim=2)
        spread = (correlation - mean[..., None]).square().mean(dim=2).clamp(min=1e-12).sqrt()
        statistics = torch.stack([peak, mean, spread, second, peak - second, similarity], dim=2)
        features = torch.cat([statistics, GROUPS * at_best, SKETCH * sketch], dim=2)
        logit = self.overlap(F.relu(self.hidden(features))).squeeze(2)
        return {"logit": logit, "shift": shift, "correlation": correlation, "similarity": similarity,
                "margin": peak - second}


class LoopNet(nn.Module):
    def __init__(self):
        super().__init__()
        self.backbone = Backbone()
        self.heads = Heads()
