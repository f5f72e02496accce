"""Worlds, motions and sensors: makes recordings with known truth."""

from app.simulation.options import ScenarioName, SceneOptions, SimulateOptions, SimulationError
from app.simulation.recording import simulate
from app.simulation.simulation import Simulation

__all__ = ["ScenarioName", "SceneOptions", "SimulateOptions", "Simulation", "SimulationError", "simulate"]
