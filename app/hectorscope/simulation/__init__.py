"""Worlds, motions and sensors: makes recordings with known truth."""

from hectorscope.simulation.options import ScenarioName, SceneOptions, SimulateOptions, SimulationError
from hectorscope.simulation.recording import simulate
from hectorscope.simulation.simulation import Simulation

__all__ = ["ScenarioName", "SceneOptions", "SimulateOptions", "Simulation", "SimulationError", "simulate"]
