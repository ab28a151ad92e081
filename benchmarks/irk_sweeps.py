"""The sweep matrices of `tlismni.core.methods.tableaus`: how they were found, and how fast their sweeps contract.

Run: python benchmarks/irk_sweeps.py [--search]. Without --search it prints the figures of the stored matrices: spectral
radius and norm of one sweep for undamped vibrations of h omega, and the largest spectral radius over all vibrations,
damped and overdamped. With --search it looks for better matrices (some minutes).

The measure that is minimised is the largest spectral radius; gauss3, where that leaves strong growth in the first
sweeps, was found with `norm_power` = 8: the norm of E^8, to the power 1/8, plus a share of the contraction for small
h omega.
"""

import argparse
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import differential_evolution, minimize
from tlismni.core.methods.tableaus import TABLEAUS, Tableau

Floats = NDArray[np.float64]
SHOWN = np.array([0.3, 1.0, 3.0, 10.0, 100.0, 1e6])
SMALL = np.array([0.3, 0.6, 1.0])


def modes(angles: int, sizes: int, real_sizes: int) -> tuple[Floats, Floats]:
    """(d, k) of the pairs of eigenvalues z in the closed left half plane: d = -(z1 + z2), k = z1 z2."""
    angle, size = np.meshgrid(
        np.linspace(0.5 * np.pi, np.pi, angles), np.concatenate([np.logspace(-1.5, 2.5, sizes), [1e6]])
    )
    real = np.concatenate([np.logspace(-1.5, 2.5, real_sizes), [1e6]])
    first, second = np.meshgrid(np.concatenate([[0.0], real]), real)
    d = np.concatenate([(-2.0 * size * np.cos(angle)).ravel(), (first + second).ravel()])
    k = np.concatenate([(size**2).ravel(), (first * second).ravel()])
    return np.maximum(d, 0.0), k


def spectral_radius(tableau: Tableau, d: Floats, k: Floats) -> Floats:
    """Of one sweep, for each mode."""
    return np.abs(np.linalg.eigvals(tableau.sweep_error(d, k))).max(axis=1)


def norm(tableau: Tableau, d: Floats, k: Floats, power: int = 1) -> Floats:
    """|E^power|^(1/power) in terms of the stages' velocities, for each mode."""
    a = np.array(tableau.a)
    of_velocities = np.linalg.matrix_power(a @ tableau.sweep_error(d, k) @ np.linalg.inv(a), power)
    return np.linalg.norm(of_velocities, 2, axis=(1, 2)) ** (1.0 / power)


def with_sweep(tableau: Tableau, x: Floats) -> Tableau:
    """The tableau with gamma = x[0] and x[1:] below the diagonal."""
    s = len(tableau.b)
    sweep = np.eye(s) * x[0]
    sweep[np.tril_indices(s, -1)] = x[1:]
    return replace(tableau, sweep=tuple(map(tuple, sweep)))


def search(tableau: Tableau, norm_power: int, seed: int = 0) -> tuple[Floats, float]:
    """(gamma and what is below the diagonal, value of the measure) of the best matrix that is found."""
    d, k = modes(7, 33, 13)

    def measure(x: Floats) -> float:
        if x[0] < 0.02:
            return 10.0
        candidate = with_sweep(tableau, x)
        if norm_power == 0:
            return min(10.0, float(spectral_radius(candidate, d, k).max()))
        small = norm(candidate, 0.0 * SMALL, SMALL**2, 2).mean()
        return min(10.0, float(norm(candidate, d, k, norm_power).max() + 0.3 * small))

    s = len(tableau.b)
    bounds = [(0.05, 0.6)] + [(-1.5, 1.5)] * (s * (s - 1) // 2)
    coarse = differential_evolution(measure, bounds, seed=seed, maxiter=300, popsize=12, tol=1e-6)
    fine = minimize(measure, coarse.x, method="Nelder-Mead", options={"maxiter": 3000, "xatol": 1e-9, "fatol": 1e-9})
    return fine.x, float(fine.fun)


def report(name: str, tableau: Tableau) -> None:
    """Print the figures of one tableau."""
    d, k = modes(25, 161, 41)
    print(f"{name}: {np.array(tableau.sweep).tolist()}")
    print(f"  largest spectral radius {spectral_radius(tableau, d, k).max():.4f}, norm {norm(tableau, d, k).max():.3f}")
    radii, norms = (f(tableau, 0.0 * SHOWN, SHOWN**2) for f in (spectral_radius, norm))
    for w, r, largest in zip(SHOWN, radii, norms, strict=True):
        print(f"  h omega = {w:<8g} spectral radius {r:.4f}  norm {largest:.4f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--search", action="store_true", help="look for the matrices anew")
    parser.add_argument("--norm-power", type=int, default=0, help="0: spectral radius; p: |E^p|^(1/p)")
    arguments = parser.parse_args()
    for name, tableau in TABLEAUS.items():
        found = tableau
        if arguments.search:
            x, value = search(tableau, arguments.norm_power)
            print(f"{name}: measure {value:.4f}")
            found = with_sweep(tableau, x)
        report(name, found)


if __name__ == "__main__":
    main()
