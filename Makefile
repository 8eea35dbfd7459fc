# The front door. Everything below needs nothing before it on a fresh Debian 12: missing packages are installed first.

# Where a build lies is not part of what ccache compares, so that presets share what they compile alike: the tests.
export CCACHE_BASEDIR ?= $(CURDIR)

PRESET ?= release
JOBS ?= $(shell nproc)
TIDY ?= src scenes oracle tools
BUILD := build/$(PRESET)

# Ninja for a new build folder, whatever an existing one was made with otherwise. In CI, warnings are errors.
configure = if command -v ninja > /dev/null && [ -z "$$CMAKE_GENERATOR" ]; then export CMAKE_GENERATOR=Ninja; fi; \
	cmake --preset $(PRESET) --log-level=WARNING $(if $(CI),-D SIGHTLINE_WERROR=ON)
build = cmake --build $(BUILD) --parallel $(JOBS)
cpp_files = find include src scenes oracle tools bench fuzz tests examples -name '*.h' -o -name '*.cpp'

.PHONY: help demo test bench gallery format format-check tidy setup
.DEFAULT_GOAL := help

help:
	@echo "make demo                   walk the built-in city and building, then bake and walk them; reports with pictures"
	@echo "make demo SCENE=path.glb    walk your own scene (CAMERA=path.json: along your own path)"
	@echo "make demo SHORT=1           the same with few frames and larger cells"
	@echo "make test                   build, then run all tests"
	@echo "make bench                  build, then run the benchmarks (SHORT=1: briefly)"
	@echo "make gallery                all pictures of docs/gallery.md anew (FULL=1: with all frames of the paper's tables)"
	@echo "make format                 lay out all C++ files as .clang-format says (format-check: only look)"
	@echo "make tidy                   clang-tidy over the library and the tool (TIDY=src: over that folder; CHECKS=-x: less x)"
	@echo "PRESET=dev|release|sanitize and JOBS=N hold for all of them. Packages that are missing get installed."

setup:
	@scripts/setup

# What a first picture needs is built first.
demo: setup
	@$(configure)
	@echo "== building what walks through a scene (three minutes of processor time)"
	@$(build) --target sightline_walk
	@CAMERA="$(CAMERA)" scripts/demo first $(BUILD)/bin/sightline-walk "$(SCENE)"
	@echo && echo "== building the rest of the tool (three minutes of processor time)"
	@$(build) --target sightline_tool
	@SHORT="$(SHORT)" CAMERA="$(CAMERA)" scripts/demo all $(BUILD)/bin/sightline "$(SCENE)"

# ctest comes last: its closing lines are the result.
test: setup
	@$(configure)
	@$(build)
	@ctest --preset $(PRESET) --parallel $(JOBS)

bench: setup
	@$(configure)
	@$(build) --target benchmarks
	@[ -x $(BUILD)/bench/drawings ] || echo "== without the benchmark drawings, which needs libgl2ps-dev"
	@for program in $$(find $(BUILD)/bench -maxdepth 1 -type f -executable | sort); do \
	  $$program $(if $(SHORT),--benchmark_min_time=0.05) || exit 1; \
	done

gallery: setup
	@$(configure)
	@$(build) --target sightline_tool --target contacts
	@FULL="$(FULL)" scripts/gallery $(BUILD)/bin/sightline $(BUILD)/bench

format:
	@scripts/setup --checks
	@$(cpp_files) | xargs clang-format -i

format-check:
	@scripts/setup --checks
	@$(cpp_files) | xargs -P $(JOBS) -n 100 clang-format --dry-run -Werror
	@echo "format: as .clang-format says"

tidy:
	@scripts/setup --checks
	@JOBS=$(JOBS) CHECKS="$(CHECKS)" scripts/tidy $(TIDY)
