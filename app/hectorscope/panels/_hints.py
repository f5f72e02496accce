"""What each figure of the page is, and when to worry: the text under the pointer."""

from collections.abc import Mapping

_SIGMAS = "Shown as one standard deviation."
_THREE = "Three standard deviations: the true value lies within in 99.7 % of all cases."

HINTS: Mapping[str, str] = {
    # the link to a robot, in the tab Station
    "clock of the robot": (
        "How far it is from the clock of this computer, if the fastest message of the last minute needed half of "
        "the round trip. Stamps are used as they are: no cause for worry here, but other programs may mind."
    ),
    "round trip": "Of the last ping over the link. Worry above 200 ms: what you see is older then.",
    "topic rate": "Messages a second. Worry if it is below what the sensor should give.",
    "latency": (
        "From the stamp of a message to its arrival, the median of the last 64, with the clock of the robot put "
        "right. A scan is stamped at its first beam. Worry if it grows: then the link is too slow."
    ),
    "age": "Time since the last message. Worry above a second.",
    "topic live": "Messages come. No cause for worry.",
    "topic silent": "Nothing came for a while. Worry if it stays so: look at the link and the sensor.",
    # the bar at the top
    "source": "What is shown: a recording, or the address of a robot. No cause for worry.",
    "server": (
        "The link of this page to the program. Worry if it is silent: the picture is old, and no button works."
    ),
    "robot": (
        "The link of the program to the robot. Worry unless it has its tick: without a link, start the "
        "bridge on the robot; without scans, its laser."
    ),
    "state": "What the run does at this moment. Worry if it says failed, or waiting while the robot should send.",
    "mode": (
        "How the saved map is used. Worry if the robot is still searched for after it has moved some metres."
    ),
    "time": (
        "Time since the start of the run, by the stamps of the sensors. Worry if it stands still while playing."
    ),
    "scans": "Scans a second that were processed. Worry if it is clearly below the rate of your laser.",
    "real time": (
        "Seconds of the recording that were processed in a second. Worry if it stays below the speed that "
        "you chose: then this computer is too slow."
    ),
    "dropped": "Scans given up because this computer was too slow for the stream. Worry if it keeps growing.",
    "skipped": (
        "Scans that gave no result; the reasons are in the list. Worry if it keeps growing. Some are normal "
        "at the start, until the inertial data has shown which way is down."
    ),
    "failed": "Parts of the page that broke and were switched off. Worry: restart the program and report it.",
    "warnings": (
        "What is wrong with the sensors at this moment, in words in the list. Worry as long as it is there."
    ),
    # the match
    "tracking": "Whether the pose in the map is known. Worry if it says degraded for seconds, or lost.",
    "residual": (
        "Mean of 1 - M over the end points of the scan, M being how occupied the map is there: 0 is a "
        "perfect fit. Worry above 0.5, or if it grows."
    ),
    "steps": (
        "Gauss-Newton steps on each level of the map, coarse to fine. Worry if it often runs out of steps "
        "before it converged."
    ),
    "scan": "Scans that have given a result so far. Worry if it stands still while scans come.",
    "beams": "Beams of this scan that were used. Worry if it is far below the number of beams of your laser.",
    "map updates": "Scans that were written into the map. Worry if it stands still while the robot moves.",
    "weakest σ": (
        "Standard deviation of the position in the direction that the match knows worst. Worry above 20 mm: "
        "the walls around the robot say little about that direction, as in a long corridor."
    ),
    "support": (
        "Share of the beams that say something about the position in that weakest direction. Worry below 6 "
        "%: the pose can slide along it."
    ),
    "unexpected": (
        "Beams that end where the map knows free space: something new, or somebody on the move. Worry above "
        "30 %: then the map may not fit any more."
    ),
    "sigmas": "One standard deviation of position and heading in the map. Worry if all three rows grow.",
    "match": f"Covariance of the scan match, R, eq. (15). {_SIGMAS} Worry if it is above that of prior.",
    "prior": f"Covariance of the prediction before the match, P. {_SIGMAS} Worry if it keeps growing.",
    "fused": f"Covariance after the fusion of both, P⁺, eq. (16). {_SIGMAS} Worry above 50 mm or 1°.",
    "ellipses": (
        "The ellipses on the map are drawn this many standard deviations large, so that they can be seen. "
        "No cause for worry."
    ),
    "residuals": (
        "Colour of each beam by its residual: 0 lies on a wall of the map, 1 in free space. Worry if most are red."
    ),
    # the pose
    "roll": "How far the robot leans to its right side. Worry if it is not near 0° on level ground.",
    "pitch": "How far the robot leans forward, nose down. Worry if it is not near 0° on level ground.",
    "yaw": "Heading in the map, counter-clockwise from its x axis. Worry if it turns while the robot stands.",
    "x": "Position along the x axis of the map. Worry if it moves while the robot stands.",
    "y": "Position along the y axis of the map. Worry if it moves while the robot stands.",
    "z": "Height above the start. Worry if it drifts on level ground.",
    # the filter
    "tilt 3σ": f"How uncertain roll and pitch are. {_THREE} Worry above 5°: scans are then levelled wrongly.",
    "heading 3σ": f"How uncertain the heading is. {_THREE} Worry above 3°.",
    "height 3σ": f"How uncertain the height is. {_THREE} Worry if it keeps growing where a height is measured.",
    "speed": (
        f"Speed of the robot and how uncertain it is, in metres a second. {_THREE} Worry if the robot stands "
        "and this is not near 0."
    ),
    "from east": (
        "How far the x axis of the map is turned from east, as satellites measured it. Worry if it changes "
        "by more than its bounds."
    ),
    "fusion ellipses": (
        "Ellipses of two standard deviations around the predicted position; the bar is their scale. Worry "
        "if match and prior do not overlap."
    ),
    "live": "This source corrects the filter. No cause for worry.",
    "rejected": (
        "The last measurements of this source contradict the filter. Worry if it lasts: check its frame, "
        "units and noise."
    ),
    "frozen": "This source repeats one value while the robot moves. Worry: check that sensor.",
    "silent": (
        "Nothing came from this source for two seconds. Worry if it should be sending; standstill and "
        "gravity are only heard while the robot stands."
    ),
    "off": "This source is switched off in the settings. No cause for worry.",
    "innovation": (
        "How far the last measurement was from the prediction, as a share of the gate; a full bar is "
        "rejected. Worry if it is often full."
    ),
    "used": "Measurements that corrected the filter. Worry if it stands still.",
    "rejected count": "Measurements beyond the gate, which contradict the filter. Worry if it keeps growing.",
    "not used": (
        "Measurements that could not be used as they came, such as too late ones. Worry if it keeps growing."
    ),
    "biases": (
        "Constant errors of the inertial sensors with three standard deviations; a track is as wide as the "
        "filter allows at the start. Worry if a mark is at an end of its track."
    ),
    "gyro °/s": (
        f"What the gyroscopes show at rest, as the filter estimates it. {_THREE} Worry if the mark is at an "
        "end of its track."
    ),
    "accel m/s²": (
        f"Constant error of the accelerometers, as the filter estimates it. {_THREE} Worry if the mark is at "
        "an end of its track."
    ),
    "unused": "Inertial data and aids that were left out, by reason. Worry if a number keeps growing.",
    # the bar at the bottom
    "clock": "Time of the recording and its length; live: since the start of the run. No cause for worry.",
}
