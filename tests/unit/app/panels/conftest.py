"""The stage of the views' tests serves here too."""

from tests.unit.app.views.conftest import stage

__all__ = ["stage"]
