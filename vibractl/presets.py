"""Rig files to begin with: what differs from the defaults, and why."""

PRESETS = {
    "underwater": """\
# A simulated vibrator in water with a hydrophone, at which the objective is judged.
# Every other key is at its default; `vibractl example-config` prints them all.
#
#   calibrate vibrator --config rig.toml --out model.h5
#   vibractl predict --config rig.toml --model model.h5
#   vibractl run --config rig.toml --model model.h5 --shots 15 --out RUN/

[rig]
name = "simulated-underwater"

[audio]
far_field_channels   = [4]    # input of the hydrophone
far_field_full_scale = 200.0  # Pa at digital full scale

[reference]
signal = "chirp:30:75:5"  # water brings the first notches down to 90 Hz: end before

[characterisation]
preload_band = [30.0, 75.0]  # Hz: work as the reference will

[quality]
where = "far-field"  # the hydrophone says whether the objective is met

[learning]
sensors = "accelerometers"  # each shell does what it should; "far-field" learns from the hydrophone itself

[simulator]
plant = "vibrator-array"

[simulator.options]
vibrators   = 1
hydrophones = 1
distance    = 10.0  # m
medium      = "water"
""",
}
