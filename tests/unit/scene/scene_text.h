// Builds SDF texts for the tests of the reader: a fragment in its surroundings, one line a tag.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "scene/sdf.h"

namespace tumble {

/// Line 1: <sdf>, line 2: <world>, the fragment from line 3 on.
inline std::string in_world(const std::string& fragment) {
  return "<sdf version='1.9'>\n<world name='test'>\n" + fragment + "\n</world>\n</sdf>\n";
}

/// Line 3: <model name='m'>, line 4: <link name='l'>, the fragment from line 5 on.
inline std::string in_link(const std::string& fragment) {
  return in_world("<model name='m'>\n<link name='l'>\n" + fragment + "\n</link>\n</model>");
}

/// Line 5: <collision name='c'> and <geometry>, the fragment from line 6 on.
inline std::string in_geometry(const std::string& fragment) {
  return in_link("<collision name='c'><geometry>\n" + fragment + "\n</geometry></collision>");
}

/// A ball in the link, so that it is complete; the fragment from line 6 on.
inline std::string beside_ball(const std::string& fragment) {
  return in_link(
      "<collision name='c'><geometry><sphere><radius>0.5</radius></sphere></geometry></collision>\n" +
      fragment);
}

/// A dynamic model of one ball, in one line.
inline std::string ball_model(const std::string& name, const std::string& more = "") {
  return "<model name='" + name + "'>" + more +
         "<link name='l'><collision "
         "name='c'><geometry><sphere><radius>0.5</radius></sphere></geometry></collision>"
         "</link></model>";
}

inline SceneReading read(const std::string& text) {
  return read_sdf_text(text, "s.sdf", TUMBLE_SCENES_DIR);
}

/// The reader's error for a text; empty if it is read.
inline std::string error_of(const std::string& text) {
  try {
    read(text);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

}  // namespace tumble
