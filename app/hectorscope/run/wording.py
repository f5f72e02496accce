"""The codes and values of the core, put into sentences: the fact, the value, the remedy."""

from collections.abc import Mapping

from hectorscope.run.arrivals import Arrival
from slam_core.diagnostics import Code, Diagnostic
from slam_core.results import Rejection, SearchFailure, StartFound, Verdict

DIAGNOSTICS: Mapping[Code, str] = {
    "map_limit": "the map stopped growing at its limit of {value:g} MB: raise map.limit or map.resolution",
    "no_gravity": "the accelerometers measure no gravity: only the yaw rate of the IMU is used; its driver must"
    " publish the specific force in m/s², gravity included",
    "no_attitude": "the inertial data does not show the attitude: it stops, or has gaps of over 0.2 s, before"
    " navigation.level_time is over; the motion is predicted from the matches alone;"
    " check the IMU, or leave it out by --imu-topic none",
    "imu_silent": "no inertial data comes: the motion is predicted from the matches alone; check the IMU",
    "gyro_clipped": "the gyro was clipped: turn slower, or set a wider range in the IMU and in"
    " navigation.gyro_range",
    "imu_clock_set_back": "the clock of the IMU was set back: the filter continues from its last state; restart if"
    " the pose is wrong",
    "imu_clock_set_ahead": "the clock of the IMU was set ahead: the filter continues from its last state; restart"
    " if the pose is wrong",
    "imu_implausible": "the IMU sends values that are not finite or not plausible: they are left out; check its"
    " driver",
    "imu_repeats": "the IMU sends the same values again: they are left out; check its driver and its link",
    "imu_spikes": "values of the IMU leap away and back: they are left out; check its cable and its link",
    "imu_shaken": "values of the IMU leap: for a moment they count less; check how it is mounted, and its link",
    "no_beam_in_range": "scans come without a beam in range: the pose is predicted without them; check the laser",
    "scans_repeated": "the laser sends the same scan again while the robot moves: such scans are left out; check"
    " its driver and its link",
    "scans_too_late": "scans come later than the state buffer reaches back: they are left out; {late}, or raise"
    " navigation.history",
    "came_together": "{source} came together after a pause, stamped on arrival: taken at a steady rate, the last"
    " at its stamp; {late}",
    "wheels_slip": "the wheels slip, spin or are stuck: their velocity is left out until the scans agree with it;"
    " check the ground and the encoders",
    "height_unknown": "nothing measures the height, and the robot stayed level: set platform.planar if it drives"
    " on a plane, else add a height source",
    "aid_implausible": "{source} sends values that are not finite or not plausible: they are left out; check that"
    " sensor",
    "aid_too_late": "{source} comes too late to be used: {late}, or raise navigation.history",
    "aid_frozen": "{source} repeats one value while the robot moves and is not used: check that sensor",
    "aid_contradicts": "{source} contradicts the other sensors and is not used: check its frame, units and noise",
}
ARRIVALS: Mapping[str, str] = {
    "late": "{source} come over 0.15 s after data of the same time: used at their own time, if it is within"
    " navigation.history, but shown late; {late}",
    "scans_stopped": "no scan came for over a second: the pose is predicted without the laser; {stopped}",
    "laser_clock_set": "the clock of the laser was set: the motion meanwhile is unknown; restart if the pose is"
    " wrong",
}
# What can be done about data that does not come in time: in a recording it is too late to repair the link.
REMEDIES: Mapping[bool, Mapping[str, str]] = {
    True: {
        "late": "check the network to the robot and the clocks of its computers",
        "stopped": "check the laser and the network to it",
    },
    False: {
        "late": "the recording has it in this order; check the clocks and the load of the recording computer",
        "stopped": "the recording has a gap there",
    },
}


def diagnostic_text(diagnostic: Diagnostic, *, live: bool = False) -> str:
    """One fault of the sensors or the map, with its remedy. live: in a stream, not in a recording."""
    text = DIAGNOSTICS[diagnostic.code]
    return text.format(source=diagnostic.source, value=diagnostic.value, **REMEDIES[live])


def arrival_text(arrival: Arrival, *, live: bool = False) -> str:
    """One fault of the stamps, with its remedy. live: in a stream, not in a recording."""
    return ARRIVALS[arrival.code].format(source=arrival.source, **REMEDIES[live])


SILENCES = frozenset(
    text
    for live in (True, False)
    for text in (
        diagnostic_text(Diagnostic("imu_silent"), live=live),
        arrival_text(Arrival("scans_stopped"), live=live),
    )
)
"""The warnings that a topic has stopped."""


def rejection_text(rejection: Rejection) -> str:
    """Why a match was rejected or is not enough."""
    value, limit = rejection.value, rejection.limit
    return {
        "overlap": f"only {value:.0%} of the scan lie where the map is known; {limit:.0%} are needed",
        "inlier_ratio": "the scan fits the map badly:"
        f" {value:.0%} of its points lie on walls, usually {limit:.0%}",
        "mahalanobis_distance": f"the match is {value:.0f} sigmas away from the predicted pose",
        "hidden": f"something near the laser hides walls of the map: {value:.0%} of the beams end before them",
        "objects": "much of what the laser sees may move:"
        f" {value:.0%} of the scan lie on objects that stand alone",
        "endpoints": f"next to nothing returns: {value:.0f} beams, and it takes {limit:.0f} to tell a place",
        "unobservable": "no beam fixes the way along one direction,"
        f" and it is only known to ±{value:.1f} m by now",
    }[rejection.code]


def verdict_text(verdict: Verdict) -> str:
    """Why the tracking state is what it is; empty while all is well."""
    reason = rejection_text(verdict.rejection) if verdict.rejection else ""
    recovery = {
        "": "",
        "relocalised": "relocalised by a search of the whole map",
        "continued": "the map continues from the prediction",
    }[verdict.recovery]
    return "; ".join(filter(None, (reason, recovery)))


def search_text(failure: SearchFailure | None) -> str:
    """Why the pose in the map is unknown; empty while it is known."""
    if failure is None:
        return ""
    match failure.code:
        case "pending":
            return "searching the whole map"
        case "no_place":
            best = f"{failure.value:.0%} of it agree at best" if failure.value else "nothing comes near"
            return f"the scan fits nowhere in the map: {best}, {failure.limit:.0%} are needed"
        case "ambiguous":
            return f"the scan fits in {failure.value:.0f} places of the map alike"
        case "crowded":
            return "the scan fits in very many places of the map"
        case "unconfirmed":
            return (
                "after a gap in the data the robot is tracked in a local map: its place in the map is not sure"
                f" ({failure.value:.0f} possible)"
            )


def moved_text(seconds: float) -> str:
    """Why a recording has no result at its beginning."""
    return (
        f"the robot moved at the beginning: the trajectory begins after {seconds:.1f} s, once scans had confirmed"
        " attitude and velocity (navigation.start_in_motion)"
    )


def start_text(start: StartFound) -> str:
    """Where the run began in the prior map."""
    x, y, psi = start.pose.tolist()
    how = "does not start at the given pose, but" if start.elsewhere else "starts"
    where = f"x {x:z.2f} m, y {y:z.2f} m, yaw {psi:z.2f} rad of the map"
    return f"the robot {how} at {where}: {start.agreement:.0%} of the scan agree"
