// What a folder has to begin with: plants by what they show, projects, settings of modules. No browser is needed here.
import { count_text } from "../../store/nodes.js";

export interface PlantBus {
  bus: string;
  bit_rate: number;
  modules: string[];
  devices: string[];
  live?: boolean;
}

export interface PlantFile {
  path: string;
  name?: string;
  buses?: PlantBus[];
  problem?: string;
}

export interface Found {
  folder: string;
  plants: PlantFile[];
  projects: string[];
  settings: string[];
  models?: string[];
  running: { number: number; path: string }[];
}

export type Kind = "plant" | "project" | "settings";
export const kind_words: Record<Kind, string> = { plant: "Plant", project: "Project", settings: "Module settings" };

export interface Entry {
  kind: Kind;
  path: string;
  name: string;
  /** "ME3CAN1-Q, 3 devices, 250 kbit/s" */
  shows: string;
  buses: readonly PlantBus[];
  problem: string;
}

function shows(buses: readonly PlantBus[]): string {
  const modules = [...new Set(buses.flatMap((one) => one.modules))];
  const devices = buses.reduce((sum, one) => sum + one.devices.length, 0);
  const rates = [...new Set(buses.map((one) => `${one.bit_rate / 1000} kbit/s`))];
  return [...modules, devices ? count_text(devices, "device") : "", buses.length > 1 ? count_text(buses.length, "bus", "buses") : "", ...(buses.length === 1 ? rates : []), buses.some((one) => one.live) ? "real bus" : ""].filter(Boolean).join(", ");
}

/** Files that all folders have are named by their folder. */
const stem = (path: string): string => path.replace(/(^|\/)(nodelist\.cpj|plant\.toml)$/, "").split("/").at(-1)?.replace(/\.\w+$/, "") || path;

/** All of a folder that match, plants first. */
export function entries_of(found: Found, find: string): Entry[] {
  const plants = found.plants.map((plant): Entry => {
    const buses = plant.buses ?? [];
    return { kind: "plant", path: plant.path, name: plant.name || stem(plant.path), shows: shows(buses), buses, problem: plant.problem ?? "" };
  });
  const others = (kind: Kind, paths: readonly string[]): Entry[] => paths.map((path) => ({ kind, path, name: stem(path), shows: kind_words[kind], buses: [], problem: "" }));
  const terms = find.toLowerCase().split(/\s+/).filter(Boolean);
  return [...plants, ...others("project", found.projects), ...others("settings", found.settings)].filter((one) => {
    const words = `${one.path} ${one.name} ${one.shows} ${kind_words[one.kind]} ${one.buses.flatMap((bus) => [bus.bus, ...bus.devices]).join(" ")}`.toLowerCase();
    return terms.every((term) => words.includes(term));
  });
}
