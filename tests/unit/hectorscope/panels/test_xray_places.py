"""Covariances on a room, a corridor and open water: what the card says of them."""

import math
import re
from typing import get_args

import numpy as np
import pytest

from hectorscope.panels._xray_places import Compared, along_axes, compare, picture, place_html, shares_html
from hectorscope.run.xray.places import Kind, place
from slam_core.matching.matcher import hessian_covariance
from slam_core.reference.scan_matching import evaluate

NOISE = 0.02


@pytest.fixture(scope="module")
def compared() -> dict[Kind, Compared]:
    """Each with its whole cloud."""
    found = {kind: compare(kind, NOISE) for kind in get_args(Kind)}
    for each in found.values():
        while not each.cloud.whole:
            each.cloud.try_next()
    return found


def test_figures_are_those_of_the_core(compared: dict[Kind, Compared]):
    """R is eq. (15) of the core for the H of the reference; the axes have the eigenvalues of the cloud."""
    for kind, each in compared.items():
        problem = place(kind)
        H = evaluate(problem.grids[0], problem.points.astype(float), problem.matched).H
        R = hessian_covariance(H, problem.config.matcher.sigma)
        np.testing.assert_allclose(each.covariances["match"], R, rtol=1e-4, atol=1e-10)
        short, long = np.linalg.eigvalsh(np.cov(each.cloud.ends.T)[:2, :2])
        assert along_axes(each.covariances)["cloud"][:2] == pytest.approx((math.sqrt(long), math.sqrt(short)))


def test_along_a_corridor_matches_hold_on_to_the_noise_of_the_map(compared: dict[Kind, Compared]):
    """It makes slopes along the walls, so that nothing shows an open direction; on water both are too sure."""
    sigmas = {kind: along_axes(each.covariances) for kind, each in compared.items()}
    long = {kind: {name: each[0] for name, each in named.items()} for kind, named in sigmas.items()}
    assert long["corridor"]["cloud"] > 20 * long["room"]["cloud"]
    assert 0.8 < long["corridor"]["match"] / long["corridor"]["cloud"] < 1.3
    assert 1.5 < long["corridor"]["sampled"] / long["corridor"]["cloud"] < 2.5
    assert long["room"]["match"] == pytest.approx(long["room"]["sampled"], rel=0.1)
    assert long["water"]["cloud"] > 2.0 * long["room"]["cloud"]
    assert max(long["water"]["match"], long["water"]["sampled"]) < long["water"]["cloud"]


def test_the_card_has_the_figures_in_millimetres(compared: dict[Kind, Compared]):
    """Each row of the table, and an ellipse for each in the picture, as long as its row says."""
    each = compared["corridor"]
    html = place_html(each)
    for long, short, psi in along_axes(each.covariances).values():
        assert f"<td>{1e3 * long:.2f}</td><td>{1e3 * short:.2f}</td><td>{math.degrees(psi):.3f}</td>" in html
    radii = {name: float(rx) for name, rx in re.findall(r'class="hs-xray-(\w+)" rx="([\d.]+)"', html)}
    values = {name: math.sqrt(np.linalg.eigvalsh(C[:2, :2])[-1]) for name, C in each.covariances.items()}
    for name in ("match", "sampled"):
        assert radii[name] / radii["cloud"] == pytest.approx(values[name] / values["cloud"], rel=0.01)


def test_shares_are_quotients_of_the_long_axes(compared: dict[Kind, Compared]):
    """Of each place, for eq. (15) and for the samples; nothing is said before a cloud is whole."""
    long = {name: values[0] for name, values in along_axes(compared["corridor"].covariances).items()}
    shares = f"{long['match'] / long['cloud']:.2g} and {long['sampled'] / long['cloud']:.2g}"
    assert f"corridor {shares}." in shares_html([compared["corridor"]])
    assert shares_html([]) == ""


def test_a_cloud_of_one_match_is_not_shown():
    """It has no covariance yet."""
    each = compare("room", NOISE)
    each.cloud.try_next()
    assert set(each.covariances) == {"match", "sampled"}
    assert picture(each.problem, each.covariances).count("<ellipse") == 2
