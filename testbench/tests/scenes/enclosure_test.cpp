#include "scenes/enclosure.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <future>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

#include "modules/config/error.h"

namespace rtusim {
namespace {

template <class Error>
std::string error_of(const std::function<mesh()>& work) {
  try {
    enclosed("a.ply", work);
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

}  // namespace

TEST_CASE("a mesh comes out of the enclosure as it is", "[enclosure]") {
  mesh m;
  for (int i = 0; i < 300'000; ++i) m.vertices.emplace_back(i, 0.1 * i, 1e-300 * i);
  for (std::uint32_t i = 0; i < 200'000; ++i) m.triangles.push_back({i, i + 1, i + 2});
  const mesh copy = enclosed("a.ply", [&] { return m; });
  CHECK((copy.vertices == m.vertices));
  CHECK((copy.triangles == m.triangles));
  CHECK(enclosed("a.ply", [] { return mesh(); }).vertices.empty());
}

TEST_CASE("an error comes out of the enclosure as it is", "[enclosure]") {
  for (const input_error& e : {input_error("a: b.ply:7", "\"x: y\"; expected z", "a; b"), input_error("", "", "")})
    CHECK(error_of<input_error>([&]() -> mesh { throw e; }) == e.what());
  CHECK(error_of<simulation_error>([]() -> mesh { throw std::runtime_error("a fault of ours"); }) == "a fault of ours");
}

TEST_CASE("what goes wrong in the enclosure stays there", "[enclosure]") {
  using Catch::Matchers::StartsWith;
  CHECK_THAT(error_of<input_error>([]() -> mesh {
               std::raise(SIGSEGV);
               return {};
             }),
             StartsWith("a.ply: the importer crashes (Segmentation fault) on it; expected a mesh"));
  CHECK_THAT(error_of<input_error>([]() -> mesh { std::abort(); }), StartsWith("a.ply: the importer crashes (Aborted) on it"));
  CHECK_THAT(error_of<input_error>([]() -> mesh { _exit(0); }), StartsWith("a.ply: the importer fails on it"));
  CHECK_THAT(error_of<input_error>([]() -> mesh {
               std::raise(SIGXCPU);
               return {};
             }),
             StartsWith("a.ply: the importer takes too long on it"));
  CHECK_THAT(error_of<input_error>([] {
               mesh broken;
               broken.vertices.resize(3);
               broken.triangles.push_back({0, 1, 3});
               return broken;
             }),
             StartsWith("a.ply: a triangle has vertex 3 of 3"));
#ifndef __SANITIZE_ADDRESS__  // under which memory is not bounded
  CHECK_THAT(error_of<input_error>([] {
               import_allowance allowance;
               allowance.admit(1000);
               mesh greedy;
               for (int i = 0; i < 64; ++i) greedy.vertices.resize(greedy.vertices.size() + 1'000'000);
               return greedy;
             }),
             StartsWith("a.ply: the importer runs out of memory on it"));
#endif
  CHECK(waitpid(-1, nullptr, WNOHANG) == -1);
  CHECK(errno == ECHILD);
}

TEST_CASE("the enclosure is not entered beside another thread", "[enclosure]") {
  std::promise<void> over;
  std::thread other([waiting = over.get_future()] { waiting.wait(); });
  CHECK_THROWS_AS(enclosed("a.ply", [] { return mesh(); }), simulation_error);
  over.set_value();
  other.join();
}

}  // namespace rtusim
