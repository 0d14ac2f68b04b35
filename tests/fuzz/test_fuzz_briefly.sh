#!/usr/bin/env bash
# A few seconds of each fuzzer; `make fuzz` takes minutes.
exec scripts/fuzz 4
