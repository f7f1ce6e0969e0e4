# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The state of a bearing in service: what is remembered of it over restarts of the program, for as long as it is in a machine."""
