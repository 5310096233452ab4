# SPDX-License-Identifier: Apache-2.0
"""The catalogue that composites are drawn from, where the user gives none: clips without an aircraft as backgrounds, and aircraft by how often
they are met near an aerodrome.

The camera is not calibrated: a field of view of 12 degrees and a pitch of 15 degrees stand for a zoom on a tripod. The sun is a guess, too.
"""

VIEW_DEG, PITCH_DEG = 12, 15
SUN_AZIMUTH_DEG, SUN_ELEVATION_DEG = 150, 45
SIZE_PX = (5, 90)
# Degrees from the boresight. A camera that watches the sky has its ground in the lower third: most aircraft are above it.
ELEVATION_IN_SKY_DEG, ELEVATION_ANYWHERE_DEG = (-1.5, 5.5), (-5, 5)
SKY_OF_TEN = 9
FIRST_FLIGHT_SEED = 301
# Width and height in px, vertical field of view in degrees, altitude in m, cloud cover, azimuth and elevation of the sun in degrees.
FLIGHTS = [(640, 480, 45, 150, 0.3, 140, 45), (640, 480, 30, 400, 0.6, 260, 20), (854, 480, 40, 800, 0.1, 180, 60), (960, 720, 35, 250, 0.9, 90, 30),
           (640, 512, 25, 60, 0.5, 20, 50), (1280, 960, 60, 300, 0.4, 320, 35), (854, 480, 50, 120, 0.8, 200, 15), (640, 480, 60, 600, 0.2, 60, 70),
           (960, 720, 30, 90, 0.0, 110, 25), (640, 480, 35, 500, 1.0, 300, 55), (1280, 960, 40, 200, 0.7, 240, 40), (640, 512, 45, 700, 0.5, 160, 65)]
# Kind: samples of a hundred, and what flies it. Types made in code and types of flightgear-data-ai; none is chosen by a measured clip.
MIX = {
    "airliner": (34, ["733/*", "738/*", "757/*", "A319/*", "A320/*", "A332/*", "CR7/*", "E90/*", "AT7/*"]),
    "business": (12, ["b1900d/*", "Citation-Bravo/*", "beech-200/*", "Saab-2000/*", "Bombardier-Challenger/*"]),
    "light": (20, ["c172/*", "c182/*", "pa-28/*", "DR400/*", "Diamond-Da42/*", "c310/*"]),
    "helicopter": (28, ["helicopter-light/*", "helicopter-turbine/*", "helicopter-twin/*", "helicopter-tandem/*"]),
    "glider": (4, ["glider/*", "paraglider/*"]),
    "other": (2, ["trike/*", "airship/*"]),
}


def backgrounds_of(clips, realism):
    """Of each (name, path of a video)."""
    tables = []
    for name, path in clips:
        table = {"name": name, "video": str(path), "lens": {"model": "pinhole", "vertical_fov_deg": VIEW_DEG},
                 "camera": {"position_ned_m": [0, 0, -2], "attitude_yaw_pitch_roll_deg": [0, PITCH_DEG, 0]},
                 "light": {"sun_azimuth_deg": SUN_AZIMUTH_DEG, "sun_elevation_deg": SUN_ELEVATION_DEG}, "motion": {"model": "none"}}
        if realism:
            table["realism"] = realism
        tables.append(table)
    return tables


def rules_of(azimuth_deg, in_sky_deg, anywhere_deg, sky_of_ten):
    return [{"name": f"{kind}-{where}-{{index}}", "count": count * share, "frame_count": 10, "aircraft": names, "size_px": list(SIZE_PX),
             "azimuth_deg": list(azimuth_deg), "elevation_deg": list(elevation), "bank_deg": "type", "start": "random"}
            for kind, (count, names) in MIX.items()
            for where, share, elevation in (("sky", sky_of_ten, in_sky_deg), ("anywhere", 10 - sky_of_ten, anywhere_deg)) if share]


def streamed(name, backgrounds, rules):
    """A catalogue with a table [stream] as a dict, for airtruth.Stream."""
    return {"name": name, "seed": 1, "background": backgrounds, "random": rules,
            "stream": {"picture": "frame", "intruders": [1, 2], "reuse": 2, "memory_mb": 400}}


def of_clips(clips, realism):
    """`realism`: the table of every background; None: the plain matte."""
    return streamed("proof", backgrounds_of(clips, realism), rules_of((-7, 7), ELEVATION_IN_SKY_DEG, ELEVATION_ANYWHERE_DEG, SKY_OF_TEN))


def flights():
    """Virtual flights of many lenses, heights, clouds and suns; the own aircraft is in view of the wider ones."""
    tables = []
    for index, (width, height, fov_deg, altitude_m, cloud_cover, azimuth_deg, elevation_deg) in enumerate(FLIGHTS):
        table = {"name": f"flight-{index}", "lens": {"vertical_fov_deg": fov_deg},
                 "flight": {"seed": FIRST_FLIGHT_SEED + index, "frame_count": 20, "width": width, "height": height, "cloud_cover": cloud_cover,
                            "altitude_m": altitude_m},
                 "camera": {"position_ned_m": [0, 0, -altitude_m], "velocity_ned_mps": [25, 0, 0]},
                 "light": {"sun_azimuth_deg": azimuth_deg, "sun_elevation_deg": elevation_deg}}
        tables.append(table)
    return tables


def of_flights(negatives):
    """`negatives`: the share of samples without an aircraft."""
    rules = [{**rule, "negatives": negatives} for rule in rules_of((-14, 14), (0, 9), (-9, 9), 10)]
    return streamed("flights", flights(), rules)
