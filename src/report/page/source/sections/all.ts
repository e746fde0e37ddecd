// The sections of the page in order.

import type { Section } from "../tools.ts";
import { checks } from "./checks.ts";
import { comparison } from "./comparison.ts";
import { convergence } from "./convergence.ts";
import { drift } from "./drift.ts";
import { engines, mechanisms } from "./engines.ts";
import { gains } from "./gains.ts";
import { inertia } from "./inertia.ts";
import { lessons } from "./lessons.ts";
import { motion } from "./motion.ts";
import { overview } from "./overview.ts";
import { scenes } from "./scenes.ts";
import { stability } from "./stability.ts";
import { tables } from "./tables.ts";
import { workPrecision } from "./work_precision.ts";

export const sections: Section[] = [
  overview, checks, scenes, workPrecision, comparison, convergence, drift, motion, stability, gains, engines, mechanisms, inertia, lessons, tables,
];
