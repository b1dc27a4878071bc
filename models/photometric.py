"""What thermal cameras and their gain controls do to an image, at random. Images are H x W float32, 0..1."""
import cv2
import numpy as np

LEVELS = 1024

def random_curve(rng, image):
    """A monotone curve of the greys: a power, a bent line of five pieces, or nothing."""
    kind = rng.random()
    if kind < 0.35:
        return np.power(image, np.exp(rng.uniform(-0.8, 0.8)), dtype=np.float32)
    if kind < 0.7:
        rises = rng.exponential(1.0, 6) + 0.15
        knots = np.concatenate([[0.0], np.cumsum(rises)]) / rises.sum()
        return curved(image, np.interp(np.linspace(0, 1, LEVELS), np.linspace(0, 1, 7), knots))
    return image


def curved(image, curve):
    """A curve of LEVELS values applied to each grey."""
    return curve.astype(np.float32)[_levels(image)]


def _levels(image):
    return np.clip(image * (LEVELS - 1) + 0.5, 0, LEVELS - 1).astype(np.int16)


def plateau_equalised(image, plateau, most_gain):
    """Histogram equalisation with the count of a grey clipped at `plateau` (a share of all pixels) and a bounded slope."""
    counts = np.bincount(_levels(image).ravel(), minlength=LEVELS) / image.size
    slope = np.minimum(counts, plateau * 256 / LEVELS)
    slope = np.minimum(slope / max(slope.sum(), 1e-9) * LEVELS, most_gain)
    curve = np.cumsum(slope) / LEVELS
    return curved(image, curve + 0.5 * (1.0 - curve[-1]))


def gain_controlled(rng, image):
    image = random_curve(rng, image)
    if rng.random() < 0.35:
        image = plateau_equalised(image, rng.uniform(0.01, 0.08), rng.uniform(2.0, 8.0))
    low, high = image.min(), image.max()
    gain = np.exp(rng.uniform(np.log(0.3), np.log(1.6))) if rng.random() < 0.8 else 1.0
    middle = 0.5 * (low + high)
    return (image - middle) * gain + np.clip(middle + rng.normal(0, 0.12), 0.2, 0.8)


def blurred(rng, image):
    if rng.random() < 0.6:
        image = cv2.GaussianBlur(image, (0, 0), rng.uniform(0.3, 1.5))
    if rng.random() < 0.2:  # a move during the exposure
        kernel = np.zeros((9, 9), np.float32)
        reach, angle = rng.uniform(1.0, 3.5), rng.uniform(0, np.pi)
        step = np.array([np.cos(angle), np.sin(angle)]) * reach
        a, b = (np.round((4 + sign * step) * 16).astype(int) for sign in (-1, 1))
        cv2.line(kernel, tuple(map(int, a)), tuple(map(int, b)), 1.0, 1, cv2.LINE_AA, 4)
        image = cv2.filter2D(image, -1, kernel / kernel.sum(), borderType=cv2.BORDER_REPLICATE)
    return image


def noisy(rng, image):
    height, width = image.shape
    if rng.random() < 0.5:
        image = image + rng.normal(0, rng.uniform(0, 0.012), (1, width)).astype(np.float32)  # columns
    if rng.random() < 0.3:
        smooth = rng.normal(0, rng.uniform(0, 0.06), (4, 4)).astype(np.float32)
        image = image + cv2.resize(smooth, (width, height), interpolation=cv2.INTER_CUBIC)
    sigma = rng.uniform(0, 0.02) if rng.random() < 0.8 else rng.uniform(0.02, 0.05)
    return image + sigma * rng.standard_normal(image.shape, np.float32)


def seen_by_a_camera(rng, image):
    """Gain control, blur, noise, rounding to 8 bits."""
    image = noisy(rng, blurred(rng, gain_controlled(rng, image)))
    return np.round(np.clip(image, 0, 1) * 255).astype(np.float32) / 255
