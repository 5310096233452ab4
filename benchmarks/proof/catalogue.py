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


def of_clips(clips, realism):
    """A catalogue with a table [stream] as a dict, for airtruth.Stream. `realism`: the table of every background; None: the plain matte."""
    rules = [{"name": f"{kind}-{where}-{{index}}", "count": count * share, "frame_count": 10, "aircraft": names, "size_px": list(SIZE_PX),
              "azimuth_deg": [-7, 7], "elevation_deg": list(elevation), "bank_deg": "type", "start": "random"}
             for kind, (count, names) in MIX.items()
             for where, share, elevation in (("sky", SKY_OF_TEN, ELEVATION_IN_SKY_DEG), ("anywhere", 10 - SKY_OF_TEN, ELEVATION_ANYWHERE_DEG))]
    return {"name": "proof", "seed": 1, "background": backgrounds_of(clips, realism), "random": rules,
            "stream": {"picture": "frame", "intruders": [1, 2], "reuse": 4, "memory_mb": 400}}
