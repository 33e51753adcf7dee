#include "src/mesh/gmsh_session.hpp"

#include <gmsh.h>

namespace ricochet::mesh {

GmshSession::GmshSession(const std::vector<std::string>& numbers) {
  std::vector<std::string> words = {"gmsh", "-nopopup", "-v", "0"};
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2)
    words.insert(words.end(), {"-setnumber", numbers[i], numbers[i + 1]});
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  gmsh::initialize(static_cast<int>(argv.size()), argv.data(), /*readConfigFiles=*/false);
  gmsh::option::setNumber("General.Terminal", 0);
  gmsh::option::setNumber("General.NumThreads", 1);
}

GmshSession::~GmshSession() { gmsh::finalize(); }

void forget_meshes() { gmsh::clear(); }

}  // namespace ricochet::mesh
