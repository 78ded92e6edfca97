# Everything here sets itself up: .venv is made on first use, from requirements.txt.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
# Tests mostly wait: more of them than cores run at once, those that wait longest first.
WORKERS ?= 5
PARALLEL := -n $(WORKERS) --dist loadfile --no-loadscope-reorder
NOBLE := .venv-noble
PEERS := .venv-peers
# A ROS installation that this shell has sourced would be found before that of .venv.
OTHER_ROS := $(strip $(foreach name,AMENT_PREFIX_PATH LD_LIBRARY_PATH PYTHONPATH,$(if $($(name)),$(name)))\
    $(if $(filter-out rmw_fastrtps_cpp,$(RMW_IMPLEMENTATION)),RMW_IMPLEMENTATION))
ifneq ($(OTHER_ROS),)
$(info Using the ROS of $(VENV), without these variables of the shell: $(OTHER_ROS))
unexport $(OTHER_ROS)
endif
# Tests start hundreds of processes, each of which would compile the package again.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help setup run test check test-noble lint docs bench bench-frame bench-node bench-clock bench-exits build clean

help:
	@echo 'make run      watch the driver at work on an emulated device'
	@echo '              PORT=/dev/ttyUSB0 for a real one, DURATION=15 to end by itself,'
	@echo '              SENSOR=titan_m for the other device'
	@echo 'make test     all tests and linters, in parallel; WORKERS=1 one after the other'
	@echo 'make check    linters, types and fast unit tests, in less than a minute'
	@echo 'make test-noble   all tests with the package versions of Ubuntu 24.04;'
	@echo '              PYTHON=python3.12 for its Python, too'
	@echo 'make lint     linters only'
	@echo 'make bench    every figure of docs/performance.md beside its floor; fifteen minutes;'
	@echo '              ROWS=decode,convert for some of them'
	@echo 'make bench-frame  what a frame costs, with its floor'
	@echo 'make bench-node   processor time and latency of the node, and a saturated line'
	@echo 'make bench-clock   how far stamps are from the truth; twenty minutes'
	@echo 'make bench-exits   how long the node takes to end after a signal; fifteen minutes'
	@echo 'make docs     generate the tables of the README and the parameter files'
	@echo 'make build    build with colcon into install/'
	@echo 'make setup    make .venv'
	@echo 'make clean    remove what was made'

setup: $(READY)

$(READY): requirements.txt setup.py setup.cfg
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check -r requirements.txt
	$(BIN)/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	@touch $@

run: $(READY)
	@$(BIN)/python tools/run.py $(if $(SENSOR),--sensor "$(SENSOR)") $(if $(PORT),--port "$(PORT)") $(if $(DURATION),--duration "$(DURATION)")

test: $(READY)
	$(BIN)/python -m pytest $(PARALLEL)

check: $(READY)
	$(BIN)/python -m pytest $(PARALLEL) -n 2 -m 'unit and not slow'

$(NOBLE)/.ready: requirements.txt test/constraints-ubuntu-24.04.txt setup.py setup.cfg
	$(PYTHON) -m venv $(NOBLE)
	$(NOBLE)/bin/pip install --quiet --disable-pip-version-check -r requirements.txt
	$(NOBLE)/bin/pip install --quiet --disable-pip-version-check --no-deps -r test/constraints-ubuntu-24.04.txt
	$(NOBLE)/bin/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	@touch $@

test-noble: $(NOBLE)/.ready
	$(NOBLE)/bin/python -m pytest $(PARALLEL)

lint: $(READY)
	$(BIN)/python -m pytest test/lint

docs: $(READY)
	$(BIN)/python tools/readme_tables.py
	$(BIN)/python tools/parameter_files.py

bench: $(READY) $(PEERS)/.ready
	PYTHONPATH=bench:test $(BIN)/python bench/run.py $(if $(ROWS),--rows "$(ROWS)")

$(PEERS)/.ready: bench/streams/requirements.txt
	$(PYTHON) -m venv $(PEERS)
	$(PEERS)/bin/pip install --quiet --disable-pip-version-check --no-deps -r $<
	@touch $@

bench-frame: $(READY)
	$(BIN)/python bench/protocol.py

bench-node: $(READY)
	PYTHONPATH=bench:test $(BIN)/python bench/node_cpu.py
	PYTHONPATH=bench:test $(BIN)/python bench/latency.py
	PYTHONPATH=bench:test $(BIN)/python bench/saturation.py

bench-exits: $(READY)
	PYTHONPATH=bench:test $(BIN)/python bench/exits.py

bench-clock: $(READY)
	PYTHONPATH=bench:test $(BIN)/python bench/clock.py --node

build: $(READY)
	. $(BIN)/activate && colcon build --paths .

clean:
	rm -rf $(VENV) $(NOBLE) $(PEERS) .bench build install log *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
