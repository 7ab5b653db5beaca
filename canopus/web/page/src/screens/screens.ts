import type { App, Screen } from "../frame/app.js";
import { BootScreen } from "./boot/boot.js";
import { BusScreen } from "./bus/bus.js";
import { EventsScreen } from "./events/events.js";
import { FaultsScreen } from "./faults/faults.js";
import { ModuleScreen } from "./module/module.js";
import { ObjectsScreen } from "./objects/objects.js";
import { OverviewScreen } from "./overview/overview.js";
import { PdosScreen } from "./pdos/pdos.js";
import { PlotsScreen } from "./plots/plots.js";
import { ProgramScreen } from "./program/program.js";
import { ProjectScreen } from "./project/project.js";
import { ScanScreen } from "./scan/scan.js";
import { SettingsScreen } from "./settings/settings.js";
import { StartScreen } from "./start/start.js";
import { TraceScreen } from "./trace/trace.js";
import { TransferScreen } from "./transfer/transfer.js";

/** In the order of the navigation. */
export function make_screens(app: App): Screen[] {
  return [new StartScreen(app), new OverviewScreen(app), new ScanScreen(app), new BusScreen(app), new BootScreen(app), new ModuleScreen(app), new ProgramScreen(app), new SettingsScreen(app), new ObjectsScreen(app), new PdosScreen(app), new TraceScreen(app),
    new PlotsScreen(app), new FaultsScreen(app), new ProjectScreen(app), new TransferScreen(app), new EventsScreen(app)];
}
