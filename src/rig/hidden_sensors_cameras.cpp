// Effects of what the cameras make of the space, and of skins that carry markers.
#include "hidden_sensors.h"

namespace softarm::rig {
namespace {

void add_scale(const HiddenChoice& choice, Scenario& scenario) {
  const auto& value = choice.values;
  CameraScale scale{value.at("share")};
  if (choice.form == "axes")
    scale.height_ratio = value.at("height_ratio");
  else
    scale.warms_s = value.at("warms_s");
  scenario.sensors.camera_scales.push_back(scale);
}

void add_bow(const HiddenChoice& choice, Scenario& scenario) {
  const auto& value = choice.values;
  CameraBow bow;
  bow.off = value.at("off");
  if (choice.form == "lenses") {
    bow.ring_m = value.at("ring_m");
    bow.height_m = value.at("height_m");
    bow.cameras = static_cast<int>(value.at("cameras"));
  } else {
    bow.form = CameraBow::Form::kFading;
    bow.fades_m = value.at("fades_m");
  }
  scenario.sensors.camera_bows.push_back(bow);
}

void add_skin(const HiddenChoice& choice, Scenario& scenario) {
  const auto& value = choice.values;
  SkinMarker skin;
  skin.body = body_of(choice, scenario);
  skin.way_m2 = value.at("way_m2");
  if (choice.form == "sleeve") {
    skin.saturates_per_m = value.at("saturates_per_m");
    skin.tilt_rad_m = value.at("tilt_rad_m");
  } else {
    skin.form = SkinMarker::Form::kPatch;
    skin.side_rad = kRadPerDeg * value.at("side_deg");
    skin.patch_m = value.at("patch_m");
  }
  scenario.sensors.skin_markers.push_back(skin);
}

}  // namespace

std::vector<HiddenEffect> camera_effects() {
  HiddenParameter ring = body_parameter();
  ring.words = "1: ring_1, ...; -1: all rings";
  return {
      {"skin_marker",
       true,
       "a ring sits on a skin that slides as the arm bends: a sleeve that shifts across the arm and tilts, "
       "or a patch on one side that moves with the strain there",
       {"sleeve", "patch"},
       {ring,
        {"way_m2", -0.02, 0.02, 1e-4, 4e-4,
         "displacement per curvature; of a sleeve: to the inside of the bend"},
        {"saturates_per_m",
         0.1,
         1e6,
         8.0,
         20.0,
         "curvature at which a sleeve shifts only half as far",
         1e6,
         false,
         {"sleeve"}},
        {"tilt_rad_m",
         -0.1,
         0.1,
         1e-3,
         4e-3,
         "tilt of a sleeve with the bend, per curvature",
         0.0,
         false,
         {"sleeve"}},
        {"side_deg",
         -360.0,
         360.0,
         -180.0,
         180.0,
         "azimuth of a patch, about z from the section's x",
         0.0,
         false,
         {"patch"}},
        {"patch_m", 1e-3, 0.2, 0.01, 0.03, "length of a patch", 0.02, false, {"patch"}}},
       add_skin},
      {"camera_scale",
       true,
       "the mocap was calibrated with a wrong length: all distances are too large by a share, heights by "
       "another share (axes), or only once the cameras are warm (warming)",
       {"axes", "warming"},
       {{"share", -0.2, 0.2, -5e-3, 5e-3, "0.001: 1 mm per m too long"},
        {"height_ratio", -2.0, 2.0, 0.85, 1.15, "share of heights over this share", 1.0, false, {"axes"}},
        {"warms_s",
         0.1,
         1e5,
         600.0,
         1800.0,
         "time constant of warming, in the time of the session",
         900.0,
         false,
         {"warming"}}},
       add_scale},
      {"camera_bow",
       true,
       "the mocap's space is bowed: the lenses of cameras in a ring are not quite as calibrated (lenses), or "
       "distances are off by a share that grows with the distance from the mocap origin and then fades "
       "(fading)",
       {"lenses", "fading"},
       {{"off", -0.5, 0.5, -0.03, 0.03,
         "lenses: share of the tangent of the angle, at 45 degrees; fading: share at 1 m if it did not fade"},
        {"ring_m",
         0.5,
         20.0,
         2.5,
         4.0,
         "distance of the cameras from the upright axis",
         3.0,
         false,
         {"lenses"}},
        {"height_m",
         -20.0,
         20.0,
         2.0,
         3.0,
         "height of the cameras above the mocap origin",
         2.5,
         false,
         {"lenses"}},
        {"cameras", 2.0, 64.0, 6.0, 12.0, "number of cameras", 8.0, true, {"lenses"}},
        {"fades_m",
         0.1,
         100.0,
         1.0,
         2.5,
         "distance at which the share has half faded",
         1.5,
         false,
         {"fading"}}},
       add_bow},
  };
}

}  // namespace softarm::rig
