// The icons of the page: drawings in the bundle, nothing is fetched.
export {
  iconAdd, iconBarchart, iconBugRuntime, iconChevronDown, iconChevronUp, iconClose, iconCodeFunction, iconConnector, iconDashboard, iconDownload, iconError, iconGanttchart, iconGenericDevice, iconHome,
  iconInfo, iconLightDark, iconLinechart, iconList, iconLock, iconLog, iconLogOut, iconNetworkWired, iconPause, iconPlay, iconPlayStepwise, iconPlc, iconProject, iconQuestion, iconRackIpc, iconRefresh, iconRocket, iconSearch,
  iconSnowflake, iconSuccess, iconSwapLeftRight, iconCogwheel, iconTable, iconTraceEye, iconTrashcan, iconUndo, iconUnlock, iconUpload, iconUser, iconWarning, iconSun, iconMoon, iconPen, iconChartCursor, iconNetworkDevice,
} from "@siemens/ix-icons/icons";
