# SPDX-License-Identifier: Apache-2.0
"""What a build makes: the pipeline, the self-contained program, wheels, the manifest."""
