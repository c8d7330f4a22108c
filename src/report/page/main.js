'use strict';
// The order of the page.

startTheme();
showVerdict();
showLadder();
showFindings();
showSpace();
showResiduals();
showWorkspace();
showParameters();
showWorst();
showDetectable();
drawCharts();
