"""Errors of the linear solver."""


class SingularMatrixError(ArithmeticError):
    """The matrix has no inverse in double precision; the message names its size and, if found, the place."""
