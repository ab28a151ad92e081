"""Records that are parameters of one compiled formula: force laws and friction laws, a user's own too."""

from typing import Any, ClassVar

from ..compiled.jit import address_of
from ..compiled.needed import compile_errors
from ..errors import ModelError
from ..model.open_union import OpenRecord


class FormulaRecord(OpenRecord):
    """Base of records with a compiled `formula` of which they are the parameters.

    Class attributes: `formula` (a numba function of the signature of its kind), `parameter_count` (how many
    parameters that signature takes), `shared_fields` (fields that are no parameters of the formula).
    """

    formula: ClassVar[Any]
    parameter_count: ClassVar[int]
    shared_fields: ClassVar[tuple[str, ...]] = ()

    def parameters(self) -> tuple[float, ...]:
        """The numbers that the formula is called with: its fields in their order, unless a class says otherwise.

        Raises
        ------
        ModelError : if a field is no number.
        """
        names = [name for name in type(self).model_fields if name not in ("type", *self.shared_fields)]
        values = {name: getattr(self, name) for name in names}
        for name, value in values.items():
            if isinstance(value, bool) or not isinstance(value, int | float):
                raise ModelError(
                    f"{type(self).__name__}.{name} = {value!r} is no number to call the formula with: define "
                    "parameters() in the class, and let it return the formula's parameters"
                )
        return tuple(float(value) for value in values.values())

    def formula_parameters(self) -> tuple[float, ...]:
        """`parameters`, filled up with zeros to `parameter_count`.

        Raises
        ------
        ModelError : if there are too many.
        """
        given = tuple(self.parameters())
        missing = self.parameter_count - len(given)
        if missing < 0:
            raise ModelError(
                f"{type(self).__name__} has {len(given)} parameters, a formula takes {self.parameter_count}: define "
                "parameters() in the class, and combine fields there so that no more are left"
            )
        return (*given, *(0.0,) * missing)


def formula_address(record: FormulaRecord, signature: Any) -> int:
    """Machine address of a record's formula, compiled for `signature`.

    Raises
    ------
    ModelError : if it is not a numba function of this signature, or does not compile.
    """
    try:
        return address_of(type(record).formula, signature)
    except Exception as error:
        if not isinstance(error, (TypeError, *compile_errors())):
            raise
        # numba goes on with where it was when it failed: only its first paragraphs say what is wrong
        cause = str(error).split("\n\nDuring:")[0]
        raise ModelError(f"the formula of {type(record).__name__} is not usable: {cause}") from error
