"""The paper's second scenario: the map carries a boat through an outage of satellites, and the other way round."""

from dataclasses import replace
from statistics import median

import numpy as np
import pytest

from benchmarks import ensemble_cases, ensembles
from benchmarks.outage import ALONE, laser_fails, satellites_fail
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.simulation import SceneOptions
from slam_core.config import SlamConfig, with_value
from slam_core.evaluation.trajectory import first_on_first, move
from slam_core.localization.placements import Placements
from slam_core.results import StepResult
from tests.integration.test_gap import cells_along

FEW_BEAMS = SceneOptions(seed=2, beams=361, scan_rate=20.0)
SEEDS = (2, 3, 4)


def test_nothing_jumps_when_satellites_go_and_come_back() -> None:
    """After 30 s without satellites the pose is within 0.1 m (1 m is asked for); no scan moves it by 5 cm."""
    found = satellites_fail(FEW_BEAMS)
    assert found.at_return < 0.1
    assert found.after < 0.1
    assert found.jump < 0.05


@pytest.mark.slow
def test_satellites_and_compass_carry_the_boat_without_a_laser() -> None:
    """Ten seconds without a scan: some decimetres off from then on, where dead reckoning strays over half a metre.

    The map goes on from where the boat then believes to be: how far off that is, satellites' noise decides.
    """
    after = [laser_fails(replace(FEW_BEAMS, seed=seed)).after for seed in SEEDS]
    assert median(after) < 0.4
    assert max(after) < 1.0
    assert laser_fails(FEW_BEAMS, ALONE).at_return > 0.5


@pytest.mark.slow
def test_satellites_and_compass_carry_a_boat_that_has_no_imu() -> None:
    """The same ten seconds in the plane: within half a metre at the end, where guessing strays over ten."""
    assert laser_fails(replace(FEW_BEAMS, imu=False)).at_return < 0.5


@pytest.mark.slow
def test_a_boat_that_got_lost_beyond_its_map_goes_on_with_it() -> None:
    """Ten seconds on, next to nothing is known: it errs by what it drifted, and hardly more from there."""
    for seed in SEEDS:
        found = laser_fails(replace(FEW_BEAMS, seed=seed), ALONE)
        assert found.after < found.at_return + 0.5


@pytest.mark.slow
@pytest.mark.parametrize("continues", [True, False])
def test_the_map_goes_on_once_twenty_metres_show_that_the_robot_has_left_it(continues: bool) -> None:
    """What was seen from the outage on is in it then. Who does not want that keeps the map as it was."""
    case = next(each for each in ensemble_cases.cases() if each.name == "handheld, no scans for 10 s")
    items = case.load(1)
    settings = Settings(with_value(SlamConfig(), "tracking.continue_from_prediction", continues))
    pipeline, lost = Pipeline(settings, items[0].stamp_ns), list[StepResult]()
    for result in (pipeline.step(each) for item in items for each in pipeline.admit(item)):
        if result and result.tracking == "lost":
            lost.append(result)
            assert not result.map_updated
    way = np.array([result.planar for result in lost])
    path = np.hypot(*np.diff(way[:, :2], axis=0).T).sum()
    assert (18.0 < path < 24.0) == continues
    assert (pipeline.result is not None and pipeline.result.tracking == "tracking") == continues
    assert (cells_along(way, pipeline) < 0.0).mean() > 0.95 if continues else path > 24.0


@pytest.mark.slow
def test_the_map_does_not_go_on_while_a_place_of_it_may_be_the_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """The scans agree with one that is not sure yet: the robot stays lost."""
    monkeypatch.setattr(Placements, "any_supported", True)
    assert ensembles.run("handheld, no scans for 10 s", 1, {}).lost_at_the_end


@pytest.mark.slow
def test_a_boat_that_comes_back_to_its_map_is_found_where_inertial_data_has_it() -> None:
    """Its first scans lie on known cells: it has not left its map. Rounding loses some of these drives."""
    runs = [ensembles.run("littoral, no scans for 8 s", variant, {}) for variant in (1, 20, 22, 25)]
    assert min(map(off_at_the_end, runs)) < 0.1


@pytest.mark.slow
@pytest.mark.parametrize("seed", [14, 36, 37])
def test_a_boat_that_returns_to_its_map_beside_the_part_it_continued_is_not_thrown_off(seed: int) -> None:
    """Matches jump there from one part to the other. As motions they would tilt the filter: it was 70 m off."""
    found = laser_fails(replace(FEW_BEAMS, seed=seed), ALONE)
    assert found.after < found.at_return + 0.5


@pytest.mark.slow
@pytest.mark.parametrize("variant", [1, 3])
def test_a_room_that_looks_alike_is_not_taken_for_the_one_of_the_prediction(variant: int) -> None:
    """Four seconds without scans into a corridor: another, ten metres off, fits better than what is not known."""
    assert error_of_a_sound_run("handheld, no scans for 4 s", variant) < 0.3


@pytest.mark.slow
@pytest.mark.parametrize("variant", [1, 4])
def test_after_ten_seconds_without_scans_no_wrong_place_is_believed(variant: int) -> None:
    """Inertial data strays by a metre or two, but not by half a turn; a place nearby is no less doubtful."""
    assert error_of_a_sound_run("arena, no scans for 10 s", variant) < 1.0


@pytest.mark.slow
def test_a_scan_that_fits_near_the_prediction_places_the_local_map() -> None:
    """It knows less than half of it. At the prediction the walk would go on with its map 0.3 m off."""
    assert error_of_a_sound_run("handheld, no scans for 8 s", 1) < 0.05


@pytest.mark.slow
def test_inertial_data_carries_a_walk_for_six_seconds() -> None:
    """It is right at once, and nothing has to be waited for."""
    run = ensembles.run("handheld, no scans for 6 s", 1, {})
    assert run.sure.all()
    assert error_of_a_sound_run("handheld, no scans for 6 s", 1) < 0.05


@pytest.mark.slow
def test_one_rejected_match_does_not_show_that_a_robot_left_its_map() -> None:
    """It was right, and waited for a search. It was set back to its prediction, 0.9 m off, and lost for good."""
    assert error_of_a_sound_run("handheld, no scans for 6 s", 4) < 0.5


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["arena", "rooms"])
def test_a_robot_that_comes_back_to_its_map_is_found_to_the_centimetre(scene: str) -> None:
    """It went on with its map a metre off, into rooms that it knew only half, and drew walls twice."""
    run = ensembles.run(f"{scene}, no scans for 10 s", 2, {})
    assert off_truth(run)[run.written].max() < 0.25
    assert off_at_the_end(run) < 0.05


def error_of_a_sound_run(case: str, variant: int) -> float:
    """Metres, of a variant that is neither lost nor far off without a word, and writes at no wrong place."""
    (outcome,) = ensembles.outcomes([ensembles.run(case, variant, {})])
    assert not (outcome.lost or outcome.misplaced or outcome.silent)
    return outcome.error


def off_at_the_end(run: ensembles.Run) -> float:
    """Metres that the last scans err at most."""
    return float(off_truth(run)[-20:].max())


def off_truth(run: ensembles.Run) -> np.ndarray:
    """(n,) metres that each pose errs."""
    assert run.truth is not None
    raw = move(first_on_first(run.truth, run.poses[:, 1:]), run.truth)
    return np.hypot(*(run.poses[:, 1:] - raw)[:, :2].T)
