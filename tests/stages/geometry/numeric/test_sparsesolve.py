"""Symmetric sparse equations: scipy's general solver as the second method, eigenvalues as the judge of the pivots."""

import numpy as np
import pytest
from scipy.sparse import csc_array, diags_array, random_array
from scipy.sparse.linalg import spsolve

from stages.errors import NoSolutionError
from stages.geometry.arrays import EPS
from stages.geometry.numeric.sparsesolve import Complex, factorised
from tests.near import assert_near


def symmetric(seed: int, count: int = 40, shift: float = 0.0) -> csc_array:
    """A sparse symmetric matrix, its eigenvalues moved by `shift`."""
    source = np.random.default_rng(seed)
    half = random_array((count, count), density=0.1, rng=source, data_sampler=source.standard_normal)
    return csc_array(half + half.T + diags_array(np.full(count, shift)))


def path(count: int) -> csc_array:
    """The Laplacian of a path: constants are in its kernel."""
    ends = np.ones(count)
    ends[[0, -1]] = 0.5
    return csc_array(diags_array([2.0 * ends, -np.ones(count - 1), -np.ones(count - 1)], offsets=[0, 1, -1]))


@pytest.mark.parametrize("seed", range(5))
def test_the_solution_is_that_of_another_solver(seed: int) -> None:
    matrix, right = symmetric(seed, shift=8.0), np.random.default_rng(seed).normal(size=40)
    values = np.linalg.eigvalsh(matrix.toarray())
    bound = 40.0 * EPS * values[-1] / values[0] ** 2 * float(np.linalg.norm(right))
    assert_near(
        factorised(matrix).solved(right), spsolve(matrix, right), bound=bound, why="40 roundings times condition"
    )


def test_a_hermitian_system_is_solved() -> None:
    twist = symmetric(7)
    matrix = csc_array(symmetric(6, shift=12.0) + 1j * (twist - csc_array(np.triu(2.0 * twist.toarray()))))
    whole = matrix.toarray()
    whole = (whole + whole.conj().T) / 2.0
    real, imaginary = np.random.default_rng(0).normal(size=(2, 40))
    right: Complex = np.asarray(real + 1j * imaginary, dtype=np.complex128)
    found = factorised(csc_array(whole)).solved_complex(right)
    assert_near(np.abs(whole @ found - right), np.zeros(40), bound=1e-12, why="a residual of some roundings of 10")


@pytest.mark.parametrize("seed", range(12))
def test_pivots_tell_whether_it_is_positive_definite(seed: int) -> None:
    lowest = float(np.linalg.eigvalsh(symmetric(seed).toarray())[0])
    for margin in (-0.3, -1e-3, 1e-3, 0.3):
        assert factorised(symmetric(seed, shift=margin - lowest)).positive == (margin > 0.0)


def test_one_negative_eigenvalue_behind_a_positive_diagonal_is_found() -> None:
    whole = np.eye(30)
    assert factorised(csc_array(whole)).positive
    whole[11, 23] = whole[23, 11] = 1.001
    assert not factorised(csc_array(whole)).positive


def test_a_singular_matrix_is_refused() -> None:
    held = csc_array(path(20)[1:, 1:])
    assert factorised(held).positive
    with pytest.raises(NoSolutionError, match="free to move"):
        factorised(path(20))
