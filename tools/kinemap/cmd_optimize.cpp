// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "core/graph/optimizer.hpp"
#include "protocol/g2o.hpp"
#include "protocol/json_text.hpp"
#include "tools/kinemap/command.hpp"
#include "tools/kinemap/files.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::cli {
namespace {

struct Options {
  std::string input;
  std::string out;
  int iterations = 100;
  double tolerance = 1e-6;
  bool json = false;
};

/// What the reader had to change or leave out, for stderr.
void warn(const Options& options, const G2oGraph& file) {
  if (file.clamped)
    fail("optimize",
         format("warning: %s: %zu information matrices were not positive definite and were moved to the nearest that "
                "is (first on line %zu)",
                options.input.c_str(), file.clamped, file.clamped_lines.front()));
  for (const auto& [tag, count] : file.skipped)
    fail("optimize", format("warning: %s: %zu lines %s left out", options.input.c_str(), count, tag.c_str()));
}

int optimize_file(const Options& options) {
  auto file = read_g2o(options.input);
  if (!file) return fail("optimize", file.error());
  warn(options, *file);
  const double before = g2o_cost(file->graph);
  graph::OptimizerOptions solver;
  solver.max_iterations = options.iterations;
  solver.function_tolerance = options.tolerance;
  const graph::Verdict verdict = graph::optimize(file->graph, solver);
  const double after = g2o_cost(file->graph);
  if (!verdict.usable) return fail("optimize", options.input + ": no usable solution: " + verdict.message);
  if (auto error = write_file(options.out, g2o_text(file->graph, file->ids))) return fail("optimize", error->message);

  if (options.json)
    return print("optimize", pretty_text({{"poses", file->graph.poses.size()},
                                          {"edges", file->graph.between.size()},
                                          {"initial_cost", before},
                                          {"final_cost", after},
                                          {"iterations", verdict.iterations},
                                          {"converged", verdict.converged},
                                          {"seconds", verdict.seconds},
                                          {"message", verdict.message}}));
  return print("optimize",
               format("%s poses, %s edges\ncost %.9g → %.9g (Σ eᵀΩe)\n%d iterations, %.3f s, %s\nwrote %s\n",
                      grouped(file->graph.poses.size()).c_str(), grouped(file->graph.between.size()).c_str(), before,
                      after, verdict.iterations, verdict.seconds, verdict.converged ? "converged" : "not converged",
                      options.out.c_str()));
}

}  // namespace

void add_optimize(CLI::App& app, Run& run) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(
      app, run, "optimize", "The optimiser alone, on any SE(3) pose graph in g2o's format",
      "  kinemap optimize sphere2500.g2o --out optimised.g2o\n"
      "  kinemap optimize out/graph.g2o --out again.g2o --json\n"
      "\nReads VERTEX_SE3:QUAT, EDGE_SE3:QUAT and FIX. Without a FIX line the first pose is held. The cost is the\n"
      "one that pose-graph benchmarks quote: translation and vector part of the quaternion, no robust loss.",
      options, optimize_file);
  command->add_option("INPUT", options->input, "Pose graph, .g2o")->required()->type_name("IN.g2o");
  command->add_option("--out", options->out, "Where the optimised graph goes")->required()->type_name("OUT.g2o");
  command->add_option("--iterations", options->iterations, "At most so many")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  command->add_option("--tolerance", options->tolerance, "Stop when the cost changes by less than this part")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  command->add_flag("--json", options->json, "Print the figures as JSON");
}

}  // namespace kinemap::cli
