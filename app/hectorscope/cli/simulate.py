"""hectorscope simulate: its options are known only once the simulator is imported, which takes long."""

from collections.abc import Callable
from typing import Annotated, Any

import tyro


def simulate_command(wanted: bool) -> Callable[..., None]:
    """The command; the simulator is imported when it is `wanted`."""

    def described() -> None:
        """Make a recording of a simulated robot, with its truth."""

    if not wanted:
        return described
    from hectorscope.cli.report import show_simulation  # noqa: PLC0415
    from hectorscope.simulation import SimulateOptions  # noqa: PLC0415

    def simulate(options: Any) -> None:
        show_simulation(options)

    simulate.__doc__ = described.__doc__
    simulate.__annotations__["options"] = Annotated[SimulateOptions, tyro.conf.arg(name="")]
    return simulate
