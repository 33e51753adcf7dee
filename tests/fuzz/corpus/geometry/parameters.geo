// DefineConstant[ commented = 1 ];
Include "n.geo"
DefineConstant[ length = {2, Min 1, Max 3, Name "a, b] = {"}, n = {4, Choices{4 = "few", 8 = "many"}} /* , ghost = 1 */ ];
If(!Exists(extra)) extra = 0; EndIf
Include "m.geo"
Merge "part.step";
