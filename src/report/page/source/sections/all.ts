// The page's sections in their order.

import type { Section } from "../tools.ts";
import { motion } from "./motion.ts";
import { overview } from "./overview.ts";
import { scenes } from "./scenes.ts";
import { tables } from "./tables.ts";
import { workPrecision } from "./work_precision.ts";

export const sections: Section[] = [overview, scenes, workPrecision, motion, tables];
