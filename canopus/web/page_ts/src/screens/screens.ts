import type { App, Screen } from "../frame/app.js";
import { BootScreen } from "./boot/boot.js";
import { BusScreen } from "./bus/bus.js";
import { EventsScreen } from "./events/events.js";
import { FaultsScreen } from "./faults/faults.js";
import { ModuleScreen } from "./module/module.js";
import { ObjectsScreen } from "./objects/objects.js";
import { OverviewScreen } from "./overview/overview.js";
import { PlotsScreen } from "./plots/plots.js";
import { TraceScreen } from "./trace/trace.js";

/** In the order of the navigation. */
export function make_screens(app: App): Screen[] {
  return [new OverviewScreen(app), new BusScreen(app), new BootScreen(app), new ModuleScreen(app), new ObjectsScreen(app), new TraceScreen(app), new PlotsScreen(app), new FaultsScreen(app), new EventsScreen(app)];
}
