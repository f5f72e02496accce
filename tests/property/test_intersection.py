"""What must hold for covariance intersection, eqs. (16)-(20), whatever the numbers."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from slam_core.kernels.fusion import kalman
from slam_core.kernels.linear import is_covariance, sandwich
from slam_core.navigation.covariance_intersection import intersect
from slam_core.reference.covariance_intersection import intersect_information

omegas = st.floats(0.01, 0.99)
seeds = st.integers(0, 10**6)
sizes = st.integers(3, 15)


def covariance(rng: np.random.Generator, n: int, spread: float = 2.0) -> np.ndarray:
    """A random covariance whose standard deviations differ by orders of magnitude."""
    axes, _ = np.linalg.qr(rng.normal(size=(n, n)))
    root = axes * 10.0 ** rng.uniform(-spread / 2, spread / 2, n)
    return root @ root.T


def is_below(a: np.ndarray, b: np.ndarray) -> bool:
    """Loewner order: b - a has no negative eigenvalue, but for rounding."""
    return bool(np.linalg.eigvalsh(b - a)[0] >= -1e-9 * np.linalg.norm(b))


@given(seeds, sizes, omegas)
def test_covariance_form_is_information_form(seed: int, n: int, omega: float) -> None:
    """Eqs. (18)-(20) as corrected give the state and covariance of (16)-(17)."""
    rng = np.random.default_rng(seed)
    P, R, C = covariance(rng, n), covariance(rng, 3), rng.normal(size=(3, n))
    x, xi = rng.normal(size=n), rng.normal(size=3)
    step, fused = intersect(P, C, R, xi - C @ x, omega)
    x_information, fused_information = intersect_information(x, P, C, xi, R, omega)
    scale = np.sqrt(np.diag(fused_information))
    assert np.allclose(fused / np.outer(scale, scale), fused_information / np.outer(scale, scale), atol=1e-5)
    assert np.allclose((x + step - x_information) / scale, 0.0, atol=1e-4)


@given(seeds, sizes, omegas)
def test_fused_covariance_is_within_what_each_source_allows(seed: int, n: int, omega: float) -> None:
    """P+ <= P / (1 - omega) and C P+ C^T <= R / omega: no direction is worse than either source alone."""
    rng = np.random.default_rng(seed)
    P, R, C = covariance(rng, n), covariance(rng, 3), rng.normal(size=(3, n))
    _, fused = intersect(P, C, R, np.zeros(3), omega)
    assert is_below(fused, P / (1.0 - omega))
    assert is_below(C @ fused @ C.T, R / omega)


@given(seeds, omegas, st.floats(-1.0, 1.0))
def test_fused_covariance_covers_the_error_however_the_sources_correlate(
    seed: int, omega: float, share: float
) -> None:
    """For every cross covariance between state and match, the true covariance of the fused error is below P+."""
    rng = np.random.default_rng(seed)
    P, R, C = covariance(rng, 6), covariance(rng, 3), rng.normal(size=(3, 6))
    mixing, _ = np.linalg.qr(rng.normal(size=(6, 6)))
    cross = share * np.linalg.cholesky(P) @ mixing[:, :3] @ np.linalg.cholesky(R).T
    gain = np.column_stack([intersect(P, C, R, unit, omega)[0] for unit in np.eye(3)])
    kept = np.eye(6) - gain @ C
    mixed = kept @ cross @ gain.T
    true = kept @ P @ kept.T + gain @ R @ gain.T + mixed + mixed.T
    assert is_below(true, intersect(P, C, R, np.zeros(3), omega)[1])


@given(seeds, omegas, st.floats(-np.pi, np.pi))
def test_an_unobservable_direction_is_left_alone(seed: int, omega: float, angle: float) -> None:
    """Neither the mean nor the variance of what is held changes, whatever becomes of the rest."""
    rng = np.random.default_rng(seed)
    P, R, C = covariance(rng, 8), covariance(rng, 3), np.eye(3, 8)
    direction = np.array([np.cos(angle), np.sin(angle)])
    held = np.zeros((2, 8))
    held[0, :2] = held[1, 3:5] = direction
    innovation = rng.normal(size=3)
    step, fused = intersect(P, C, R, innovation, omega, unobservable=direction, held=held)
    size = np.sqrt(np.diag(held @ P @ held.T))
    assert np.allclose(held @ step / size, 0.0, atol=1e-6)
    assert np.allclose(np.diag(held @ fused @ held.T) / size**2, 1.0, atol=1e-6)
    assert np.linalg.eigvalsh(fused)[0] > -1e-9 * np.linalg.norm(fused)
    further = innovation + 7.0 * np.array([*direction, 0.0])
    again, _ = intersect(P, C, R, further, omega, unobservable=direction, held=held)
    assert np.allclose(again, step, rtol=1e-6, atol=1e-9)


def test_a_plain_kalman_update_would_not_cover_it() -> None:
    """With a match whose error is the state's own, the Kalman update claims half the variance that is left."""
    P = R = C = np.eye(1)
    gain, claimed = kalman(P, C, R, np.ones(1))
    true = (1 - gain[0]) ** 2 + gain[0] ** 2 + 2 * gain[0] * (1 - gain[0])
    assert np.isclose(true, 1.0) and np.isclose(claimed[0, 0], 0.5)


@settings(max_examples=30)
@given(seeds, omegas, st.floats(1e-12, 1e3))
def test_a_long_run_of_fusions_stays_a_covariance(seed: int, omega: float, size: float) -> None:
    """After fifty fusions with growth between, P is exactly symmetric, finite and positive definite."""
    rng = np.random.default_rng(seed)
    P, Q = covariance(rng, 15, 6.0), covariance(rng, 15, 6.0)
    for _ in range(50):
        C = rng.normal(size=(3, 15))
        _, P = intersect(P, C, size * covariance(rng, 3), np.zeros(3), omega)
        P = sandwich(np.eye(15) + 0.01 * rng.normal(size=(15, 15)), P + 1e-3 * Q)
        P /= max(1.0, np.trace(P) / 1e3)
        assert (P == P.T).all() and np.isfinite(P).all()
        scale = np.sqrt(np.diag(P))
        assert np.linalg.eigvalsh(P / np.outer(scale, scale))[0] > -1e-12


@given(seeds)
def test_is_covariance_tells_covariances_from_other_matrices(seed: int) -> None:
    """Positive definite ones pass; with a negative eigenvalue, NaN, infinity or without symmetry they do not."""
    rng = np.random.default_rng(seed)
    R = covariance(rng, 3)
    assert is_covariance(R)
    values, axes = np.linalg.eigh(R)
    assert not is_covariance(axes @ np.diag([-values[0], *values[1:]]) @ axes.T)
    for value in (np.nan, np.inf, -np.inf):
        broken = R.copy()
        broken[seed % 3, (seed // 3) % 3] = value
        assert not is_covariance(broken)
    assert not is_covariance(R + np.triu(np.full((3, 3), R.max()), 1))


@given(st.floats(0.01, 100.0), seeds)
@settings(max_examples=20)
def test_a_chosen_omega_is_the_best_there_is(share: float, seed: int) -> None:
    """No fixed weight gives a smaller determinant, or trace relative to P, than the one that is chosen."""
    rng = np.random.default_rng(seed)
    P, R = covariance(rng, 6), share * covariance(rng, 3)
    C = rng.normal(size=(3, 6))
    measures = {
        "trace": lambda A: np.sum(np.diag(A) / np.diag(P)),
        "determinant": lambda A: np.linalg.slogdet(A)[1],
    }
    for method, measure in measures.items():
        chosen = measure(intersect(P, C, R, np.zeros(3), 0.5, method)[1])
        fixed = [measure(intersect(P, C, R, np.zeros(3), w, "fixed")[1]) for w in np.linspace(0.001, 0.998, 200)]
        assert chosen <= min(fixed) + 1e-6 * max(1.0, abs(min(fixed)))  # a logarithm may be near zero
        assert chosen <= measure(P) + 1e-4


def test_a_match_of_no_use_is_left_alone() -> None:
    """A noise far above the belief: the chosen omega is nearly zero and leaves the belief as it was."""
    for method in ("trace", "determinant"):
        step, P = intersect(np.eye(6), np.eye(3, 6), 1e6 * np.eye(3), np.ones(3), 0.5, method)
        assert np.abs(step).max() < 1e-9 and np.allclose(P, np.eye(6), atol=1e-4)


def test_the_third_choice_is_the_kalman_update() -> None:
    """Its covariance is that of independent errors, whatever omega says."""
    rng = np.random.default_rng(1)
    P, R, C = covariance(rng, 6), covariance(rng, 3), rng.normal(size=(3, 6))
    gain = P @ C.T @ np.linalg.inv(C @ P @ C.T + R)
    step, fused = intersect(P, C, R, np.ones(3), 0.1, "kalman")
    assert np.allclose(step, gain @ np.ones(3)) and np.allclose(fused, P - gain @ C @ P)
