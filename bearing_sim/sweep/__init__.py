# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
