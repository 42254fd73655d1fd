// Where MuJoCo's package is not installed (see CMakeLists.txt) it is not compared.
#include "peers/peer.h"

namespace tumble::bench {

std::vector<Method> mujoco_methods() {
  return {};
}

}  // namespace tumble::bench
