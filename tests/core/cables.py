"""Matrices and equilibria of models with cables, for the tests."""

import numpy as np
from scipy.optimize import brentq
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import spsolve
from tlismni.core.assembly.evaluate import evaluate_residuals, evaluate_tangent
from tlismni.core.assembly.workspace import Workspace

EA, EI, LINE, LENGTH = 500.0, 0.7, 1.3, 2.0


def straight(elements, **fields):
    """Fields of a straight cable."""
    return {
        "name": "cable", "elements": elements, "length": LENGTH, "mass_per_length": LINE, "axial_stiffness": EA,
        "bending_stiffness": EI,
    } | fields  # fmt: skip


class System:
    """A model at rest at some place, asked for its residual, mass and stiffness."""

    def __init__(self, model):
        self.workspace = Workspace(model.assemble())
        self.n, self.m = self.workspace.assembly.n, self.workspace.assembly.m
        self.q0 = self.workspace.assembly.q0.copy()

    def residual(self, q, lam=None):
        """(r, phi) at rest."""
        arrays = self.workspace.arrays
        arrays["q"][: self.n] = q
        arrays["lam"][: self.m] = 0.0 if lam is None else lam
        evaluate_residuals(self.workspace.record)
        return arrays["r"][: self.n].copy(), arrays["phi"][: self.m].copy()

    def matrix(self, c_q):
        """M + c_q K with the constraints' rows and columns, sparse, at the place of the last residual."""
        evaluate_tangent(self.workspace.record, c_q, 0.0)
        s = self.workspace.structure
        size = self.n + len(s.active)
        return csc_matrix((self.workspace.arrays["values"][: s.nnz], (s.rows, s.cols)), shape=(size, size))

    def mass_and_stiffness(self, q):
        """Dense M and K."""
        self.residual(q)
        mass = self.matrix(0.0).toarray()[: self.n, : self.n]
        return mass, self.matrix(1.0).toarray()[: self.n, : self.n] - mass

    def equilibrium(self, q=None, iterations=60):
        """(q, lam) without motion, by Newton with increments of at most 0.3."""
        q, lam = (self.q0 if q is None else q).copy(), np.zeros(self.m)
        for _ in range(iterations):
            r, phi = self.residual(q, lam)
            whole, mass = self.matrix(1.0), self.matrix(0.0)
            inert = mass[: self.n, : self.n]
            whole[: self.n, : self.n] -= inert
            step = spsolve(csc_matrix(whole), -np.concatenate([r, phi]))
            largest = np.abs(step[: self.n]).max()
            share = min(1.0, 0.3 / largest)
            q += share * step[: self.n]
            lam += share * step[self.n :]
            if largest < 1e-12:
                return q, lam
        raise AssertionError("no equilibrium found")


def beam_frequencies(kind, count):
    """beta L of the first bending modes of an Euler-Bernoulli beam, from its frequency equation."""
    if kind == "supported":
        return np.pi * np.arange(1, count + 1)
    sign = 1.0 if kind == "cantilever" else -1.0
    # cos x cosh x = -+1, divided by cosh x
    equation = lambda x: np.cos(x) + sign / np.cosh(x)  # noqa: E731
    first = 0 if kind == "cantilever" else 1
    return np.array([brentq(equation, np.pi * k, np.pi * (k + 1), xtol=1e-15) for k in range(first, first + count)])
