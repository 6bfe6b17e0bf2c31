#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Build a target, as the firmware's build.sh does: ./build.sh -t TARGET; ./build.sh --help says more.
exec "$(dirname -- "$(readlink -f -- "$0")")/island" build "$@"
