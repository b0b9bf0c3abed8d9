"""import_vendors.py: one press in the dress of many testers' exports, after their real layouts, and what each must become.

    import_vendors.py DIR             writes the files
    import_vendors.py --compare OUT   compares OUT/FILE/*.csv; exit 1 with what differs
"""
import math
import os
import sys


def press(k):
    """1 s at rest, 3 mm in 3 s, 3 s dwell; F = 2 d, to half in the dwell."""
    t = k / 10
    d = 0 if t < 1 else t - 1 if t < 4 else 3.0
    return t, d, 2 * d if t <= 4 else 3 + 3 * math.exp(4 - t)


def jpk_press(t):
    """Of a cantilever, in um and in units of its largest force."""
    depth = min(t - 1, 3 - t)
    return t, depth, max(depth, 0)


R = [press(k) for k in range(71)]


def rows(row, part=R):
    return ''.join(row(k, *values) for k, values in enumerate(part))


def w(name, text, enc='utf-8', eol='\r\n'):
    with open(os.path.join(sys.argv[1], name), 'wb') as out:
        out.write(text.replace('\n', eol).encode(enc))


def c(s):
    return s.replace('.', ',')


def write_all():
    def tra(name,names,units,head,enc='latin-1'):
        w(name, head+';'.join(f'"{n}"' for n in names)+'\n'+';'.join(f'"{u}"' for u in units)+'\n'+rows(lambda k, t, d, f: c(f'{t:.2f};{d:.4f};{f:.5f}')+'\n'),enc)
    tra('zwick_it.TRA',['Tempo di prova','Corsa standard','Forza standard'],['s','mm','N'],'"Altezza del provino";20,0;"mm"\n"Diametro";10,0;"mm"\n')
    tra('zwick_es.TRA',['Tiempo de ensayo','Recorrido estándar','Fuerza estándar'],['s','mm','N'],'"Altura de la probeta h0";20,0;"mm"\n')
    tra('zwick_pt.TRA',['Tempo de ensaio','Percurso padrão','Força padrão'],['s','mm','N'],'"Altura do corpo de prova";20,0;"mm"\n')
    tra('zwick_fr.TRA',['Temps de test','Course standard','Force standard'],['s','mm','N'],'"Hauteur de l\'éprouvette";20,0;"mm"\n"Diamètre d0";10,0;"mm"\n')

    # testXpert III: key/value header, deformations, nominal
    w('zwick_iii.csv','"Prüfnorm";"";"ISO 604"\n"Probe 1"\n"Probendicke a0";5,00;"mm"\n"Probenhöhe h0";20,00;"mm"\n"Vorkraft";0,1;"N"\n"Prüfgeschwindigkeit";60;"mm/min"\n\n"Prüfzeit";"Standardkraft";"Traversenweg absolut";"Standardweg";"Nominelle Stauchung"\n"s";"N";"mm";"mm";"%"\n'+rows(lambda k, t, d, f: c(f'{t:.3f};{f:.5f};{120-d:.4f};{d:.4f};{d/20*100:.4f}')+'\n'),'utf-8-sig')
    # BlueHill 2: Extension and compressive extension
    w('bluehill2.csv','"Specimen label","gel 1"\n"Height","20.00000","mm"\n"Diameter","10.00000","mm"\n"Rate 1","60.00000","mm/min"\n\n"Time","Extension","Load","Compressive extension","Compressive load","Compressive strain (Extension)","Compressive stress"\n"(sec)","(mm)","(N)","(mm)","(N)","(mm/mm)","(MPa)"\n'+rows(lambda k, t, d, f: f'"{t:.3f}","{-d:.5f}","{-f:.5f}","{d:.5f}","{f:.5f}","{d/20:.6f}","{f/78.53981634:.7f}"\n'))
    # WaveMatrix
    w('wavematrix.csv','"Total Time (s)","Cycle Elapsed Time (s)","Total Cycles","Elapsed Cycles","Step","Total Cycle Count(8800 (0,1) Waveform)","Position(8800 (0,1):Position) (mm)","Load(8800 (0,1):Load) (kN)"\n'+rows(lambda k, t, d, f: f'{t+3:.4f},{t%2:.4f},{int(t/2)},{int(t/2)},1,{int(t/2)},{-d-4:.6f},{-f/1000:.9f}\n'))
    # MTS 793
    w('mts793.dat','MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A\n\nData Header:\tTime:\t 1.5 \tSec\t3/1/2024 10:15:00 AM\nData Acquisition:\tTimed\nStation Name: \tgel.cfg\nTest File Name: \tgel.000\nAxial Count\tAxial Displacement\tAxial Force\tRunning Time\nsegments\tmm\tN\tSec\n'+rows(lambda k, t, d, f: f'{int(t)}\t{-d:.6f}\t{-f:.6f}\t{t+1.5:.5f}\n'))
    w('mts_testsuite.csv','Test Name:,gel compression\nSpecimen,gel-3\nThickness,20.0,mm\n\nDAQ- Crosshead, … - (Timed)\nCrosshead ,Load ,Time ,Extensometer 1 ,Strain 1 \nmm,N,sec,mm,mm/mm\n'+rows(lambda k, t, d, f: f'{d:.6f},{f:.6f},{t:.5f},0,0\n'))
    # Shimadzu one specimen
    w('trapezium1.csv','"Key Word","","Product Name","gel"\n"Test File Name","gel.xtak","Method File Name","comp.xmak"\n"Report Date","2024/03/01","Test Date","2024/03/01"\n"Shape","Rod","No of Batches:","1"\n\n"Name","Height","Diameter"\n"Units","mm","mm"\n"1 _ 1","20.0000","10.0000"\n\n"1 _ 1"\n"Time","Force","Stroke"\n"sec","N","mm"\n'+rows(lambda k, t, d, f: f'"{t:.2f}","{f:.5f}","{d:.5f}"\n'))
    # Shimadzu two specimens side by side
    w('trapezium2.csv','"Key Word","","Product Name","gel"\n"Test Date","2024/03/01"\n\n"Name","Height","Diameter"\n"Units","mm","mm"\n"1 _ 1","20.0","10.0"\n"1 _ 2","25.0","12.0"\n\n"1 _ 1","","","1 _ 2","",""\n"Time","Force","Stroke","Time","Force","Stroke"\n"sec","N","mm","sec","N","mm"\n'+rows(lambda k, t, d, f: f'"{t:.2f}","{f:.5f}","{d:.5f}","{t:.2f}","{2*f:.5f}","{d:.5f}"\n' if k<60 else f'"{t:.2f}","{f:.5f}","{d:.5f}"\n'))
    # Nexygen
    w('nexygen.txt','NEXYGENPlus\nSample: gel\nHeight (mm): 20\n\nTime (s)\tLoad (N)\tMachine Extension (mm)\tExtension from Preload (mm)\tStress (MPa)\n'+rows(lambda k, t, d, f: f'{t:.3f}\t{f:.5f}\t{d:.5f}\t{max(d-0.1,0):.5f}\t{f/78.54:.6f}\n'))
    # Exponent
    w('exponent.txt','Force\tDistance\tTime\ng\tmm\tsec\n'+rows(lambda k, t, d, f: f'{f/9.80665e-3:.4f}\t{d:.4f}\t{t:.3f}\n'))
    w('exponent_arc.csv','gel1.arc,,,gel2.arc,,\nForce,Distance,Time,Force,Distance,Time\n(g),(mm),(sec),(g),(mm),(sec)\n'+rows(lambda k, t, d, f: f'{f/9.80665e-3:.4f},{d:.4f},{t:.3f},{2*f/9.80665e-3:.4f},{d:.4f},{t:.3f}\n'))
    # CellScale
    w('univert.csv','SetName,Cycle,Time_S,Temperature,CurrentSize_mm,Displacement_mm,Force_mN\n'+rows(lambda k, t, d, f: f'{"1-Compress" if t<4 else "2-Hold"},1,{t:.2f},37.0,{20-d:.5f},{d:.5f},{1000*f:.3f}\n'))
    w('microsquisher.csv','Time_S,BaseDisp_um,TipDisp_um,Size_um,Displacement_um,Force_uN\n'+rows(lambda k, t, d, f: f'{t:.2f},{1000*d+5*f:.4f},{1000*d:.4f},{20000-1000*d:.4f},{1000*d:.4f},{1e6*f:.2f}\n'))
    # WinTest
    w('wintest2.txt','TIMED DATA\nPoints\tElapsed Time \tScan Time \tDisp \tLoad 225N \n\t Sec \t Sec \t mm \t N \n'+rows(lambda k, t, d, f: f'{k}\t{t+0.5:.4f}\t{t:.4f}\t{-d-2:.5f}\t{-f:.5f}\n'))
    # Anton Paar
    w('rheocompass.csv','Project:\tgel\nTest:\tgel 1\nResult:\tCompression 1\nInterval and data points:\t1\t71\nInterval data:\tPoint No.\tTime\tGap\tNormal Force\tStatus\n\t\t[s]\t[mm]\t[N]\t[]\n'+rows(lambda k, t, d, f: f'\t{k+1}\t{t:.2f}\t{20-d:.4f}\t{f:.5f}\tDy_\n'),'utf-16')
    w('rheoplus.txt','Data Series Information\nName:\tgel 1\nNumber of Intervals:\t2\n\nInterval:\t1\nNumber of Data Points:\t41\nTime Setting:\t41 Meas. Pts.\n\nMeas. Pts.\tTime\tGap\tNormal Force\tStatus\n\t[s]\t[mm]\t[N]\t[]\n'+rows(lambda k, t, d, f: f'{k+1}\t{t:.2f}\t{20-d:.4f}\t{f:.5f}\tDSO\n', R[:41])+'\nInterval:\t2\nNumber of Data Points:\t30\n\nMeas. Pts.\tTime\tGap\tNormal Force\tStatus\n\t[s]\t[mm]\t[N]\t[]\n'+rows(lambda k, t, d, f: f'{k+1}\t{t:.2f}\t{20-d:.4f}\t{f:.5f}\tDSO\n', R[41:]))
    # JPK
    def jpk(seg,rows,first):
        h=('# xPosition: 1e-6\n# yPosition: 1e-6\n# force-scan-series.header.type: quantitative-imaging\n' if first else '')+f'#\n# segment: {seg}\n# springConstant: 0.05\n# sensitivity: 6.1e-8\n# columns: smoothedCapacitiveSensorHeight vDeflection seriesTime time\n# fancyNames: "Height (measured & smoothed)" "Vertical deflection" "Series Time" "Segment Time"\n# units: m N s s\n#\n'
        t0=rows[0][0]
        return h+''.join(f'{50e-6-z-fn/0.05:.9e} {fn:.9e} {t:.6f} {t-t0:.6f}\n' for t,z,fn in rows)+'\n'
    J=[]
    for k in range(301):
        t=k/100; z=(k-100)*1e-8 if k<=200 else (300-k)*1e-8
        J.append((t,z,1e-2*max(z,0)))
    w('jpk.txt',jpk('extend',J[:201],True)+jpk('retract',J[201:],False),eol='\n')
    # Piuma
    w('piuma.txt','Date\t1-3-2024\nTime\t10:15:00\nCalibration ID\t7\nTip radius (um)\t24.5\nk (N/m)\t0.5\nSMDuration (s)\t2\nPiezo Indentation Sweep Settings\nProfile:\tDisplacement\nD[Z1] (nm)\t10000\nt[1] (s)\t2\n\nTime (s)\tLoad (uN)\tIndentation (nm)\tCantilever (nm)\tPiezo (nm)\tAuxiliary\n'+rows(lambda k, t, d, f: f'{t:.4f}\t{f:.6f}\t{d*1000:.4f}\t{f*2000:.4f}\t{d*1000+f*2000:.4f}\t0\n'))
    # Hysitron
    w('hysitron.txt','gel_000 LC.hys\n\nNumber of Points\t71\n\nDepth (nm)\tLoad (µN)\tTime (s)\tDepth (V)\tLoad (V)\n'+rows(lambda k, t, d, f: f'{1000*d:.4f}\t{100*f:.5f}\t{t:.5f}\t{d/100:.7f}\t{f/50:.7f}\n'),'latin-1')
    # FemtoTools
    w('femtotools.txt','FemtoTools NMT04\nDate: 2024-03-01\nSensor: FT-S200\nSensor stiffness [N/m]: 300\n\nIndex [#]\tPhase [#]\tTime [s]\tDisplacement [µm]\tForce A [µN]\tForce B [µN]\tPos X [µm]\tPos Y [µm]\tPos Z [µm]\n'+rows(lambda k, t, d, f: f'{k}\t1\t{t:.4f}\t{d:.5f}\t{f:.5f}\t0.00000\t100\t200\t{300-d:.5f}\n'))
    # ADMET
    w('admet.csv','MTESTQuattro\nTest Procedure,Compression\nSpecimen ID,gel\nHeight (in),0.787401575\nDiameter (in),0.393700787\nMaximum Load (lbf),1.35\n\nTime(s),Load(lbf),Position(in),Stress(psi),Strain(%)\n'+rows(lambda k, t, d, f: f'{t:.3f},{f/4.4482216:.7f},{d/25.4:.7f},{f/4.448/0.12:.5f},{d/20*100:.4f}\n'))
    # Mecmesin
    w('vectorpro.csv','Test 1 - Load (N),Test 1 - Displacement (mm),Test 1 - Time (s),Test 2 - Load (N),Test 2 - Displacement (mm),Test 2 - Time (s)\n'+rows(lambda k, t, d, f: f'{f:.4f},{d:.4f},{t:.3f},{2*f:.4f},{d:.4f},{t:.3f}\n'))
    w('emperor.txt','Emperor(TM) Force\nTest: gel\nSample height (mm) 20\nSample 1\nTime (s),Load (N),Disp. (mm)\n'+rows(lambda k, t, d, f: f'{t:.3f},{f:.4f},{d:.4f}\n')+'\nSample 2\nTime (s),Load (N),Disp. (mm)\n'+rows(lambda k, t, d, f: f'{t:.3f},{2*f:.4f},{d:.4f}\n'))
    # LVM
    lh='LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t%s\nMulti_Headings\tNo\nX_Columns\t%s\nTime_Pref\tRelative\nOperator\tlab\nDate\t2024/03/01\nTime\t10:15:00.123456\n***End_of_Header***\t\n\t\nChannels\t2\t\nSamples\t71\t71\t\nDate\t2024/03/01\t2024/03/01\t\nTime\t10:15:00\t10:15:00\t\nY_Unit_Label\t%s\t%s\t\nX_Dimension\tTime\tTime\t\nX0\t0,0000000E+0\t0,0000000E+0\t\nDelta_X\t0,100000\t0,100000\t\n***End_of_Header***\t\t\n'
    w('one.lvm',(lh%('.','One','Millimeters','Newtons')).replace(',','.')+'X_Value\tDisplacement\tForce\tComment\n'+rows(lambda k, t, d, f: f'{t:.6f}\t{d:.6f}\t{f:.6f}\n'))
    w('no.lvm',lh%(',','No','mm','N')+'X_Value\tWeg\tKraft\tComment\n'+c(rows(lambda k, t, d, f: f'\t{d:.6f}\t{f:.6f}\n')))
    w('multi.lvm',(lh%('.','Multi','mm','N')).replace(',','.').replace('mm\tN','mm\t\tN').replace('\t0.0000000E+0\t0.0','\t0.0000000E+0\t\t0.0')+'X_Value\tDisplacement\tX_Value\tForce\tComment\n'+rows(lambda k, t, d, f: f'{t:.6f}\t{d:.6f}\t{t:.6f}\t{f:.6f}\n'))
    # Mark-10
    # PASCO, Vernier
    w('pasco.csv','"Time (s) Run #1","Force (N) Run #1","Position (m) Run #1","Time (s) Run #2","Force (N) Run #2","Position (m) Run #2"\n'+rows(lambda k, t, d, f: f'{t:.3f},{f:.4f},{d/1000:.7f},{t:.3f},{2*f:.4f},{d/1000:.7f}\n'))
    w('pandas.csv',',time_s,disp_mm,force_N\n'+rows(lambda k, t, d, f: f'{k},{t:.3f},{d:.4f},{f:.4f}\n'))
    # no time
    w('notime.csv','Sampling rate: 10 Hz\nForce (N),Displacement (mm)\n'+rows(lambda k, t, d, f: f'{f:.4f},{d:.4f}\n'))
    # Tinius Olsen
    w('horizon.txt','Test Results\nSpecimen height\t20.0 mm\n\nTime\tForce\tPosition\tExtension\nsec\tN\tmm\tmm\n'+rows(lambda k, t, d, f: f'{t:.3f}\t{f:.4f}\t{d:.4f}\t0.0000\n'))
    # TRIOS RSA-G2
    w('rsag2.txt','Filename\tgel.tri\nInstrument name\tRSA-G2\nInstrument type\tRSA-G2\nGeometry name\tcompression\nLoading gap\t21.0 mm\nSample Height\t20.0 mm\nDiameter\t10.0 mm\n\n[step]\nStress relaxation - 1\nNumber of points\t71\nVariables\tTime\tTemperature\tStress\tStrain\tGap\tAxial force\ts\t°C\tPa\t%\tmm\tN\n'.replace('\ts\t°C','\nUnits\ts\t°C')+rows(lambda k, t, d, f: f'Data point\t{t:.3f}\t25.0\t{f/78.5398*1e6:.4f}\t{d/20*100:.5f}\t{20-d:.5f}\t{f:.5f}\n'))

    w('sep.csv','sep=;\n"Zeit";"Kraft";"Weg"\n"[s]";"[N]";"[mm]"\n'+rows(lambda k, t, d, f: c(f'"{t:.2f}";"{f:.4f}";"{d:.4f}"\n')))
    w('stamp.csv','timestamp,position_mm,force_N\n'+rows(lambda k, t, d, f: f'2024-03-01T10:00:{t+5:06.3f}Z,{d:.4f},{f:.4f}\n'))
    w('in.csv','Zeit in s;Weg in mm;Kraft in N\n'+rows(lambda k, t, d, f: c(f'{t:.2f};{d:.4f};{f:.4f}\n')))
    w('threelines.txt','Test 4\n\nElapsed     Crosshead   Axial\nTime        Position    Load\n(s)         (mm)        (N)\n'+rows(lambda k, t, d, f: f'{t:<12.2f}{d:<12.4f}{f:<.4f}\n'))
    w('netzsch.txt','#FORMAT: NETZSCH5\n#SAMPLE: gel\n#DECIMAL: POINT\n#SEPARATOR: SEMICOLON\n\n##Time/min;Force/N;Displacement/µm;Temp./°C\n'+rows(lambda k, t, d, f: f'{t/60:.7f};{f:.5f};{1000*d:.3f};25.0\n'))
    w('mettler.txt','Curve Name:\n  Force\nCurve Values:\n       Index             t             F             s\n                       [s]           [N]          [um]\n'+rows(lambda k, t, d, f: f'{k:12d}{t:14.3f}{f:14.5f}{1000*d:14.3f}\n'))
    w('g200.csv','Segment,Displacement Into Surface,Load On Sample,Time On Sample,Harmonic Contact Stiffness\n,nm,mN,s,N/m\n'+rows(lambda k, t, d, f: f'{"Surface Approach Segment" if k==0 else "Load Segment Type" if k==10 else "Hold" if k==40 else ""},{1000*d:.4f},{f:.5f},{t:.3f},0\n'))
    w('kinexus.csv','"Action Name";"Time (action)(s)";"Gap(mm)";"Normal force(N)";"Temperature(°C)"\n'+rows(lambda k, t, d, f: f'"Squeeze";"{t:.3f}";"{20-d:.5f}";"{f:.5f}";"25.0"\n'))
    w('haake.txt','Company / Operator: lab\nDate/Time/Version: 01.03.2024 / 10:15:00 Uhr / HAAKE RheoWin 4.63\nSubstance/Sample no: gel / 4\nGap: 20.0 mm\n\nt in s;h in mm;FN in N\n'+rows(lambda k, t, d, f: c(f'{t:.3f};{20-d:.5f};{f:.5f}\n')),'latin-1')
    w('seriesix.csv','"Sample ID","gel"\n"Sample Rate (pts/secs):","10.000"\n"Crosshead Speed (mm/min):","60.0"\n"Height (mm):","20.0"\n\n"Extension (mm)","Load (N)"\n'+rows(lambda k, t, d, f: f'{d:.5f},{f:.5f}\n'))
    w('ap_indent.txt','Sample\tgel\nIndenter\tSpherical\nRadius\t500 µm\n\nTime [s]\tPd [nm]\tFn [mN]\n'+rows(lambda k, t, d, f: f'{t:.3f}\t{1000*d:.3f}\t{f:.5f}\n'))
    w('excel_de.csv','Messung;Gel 4;;\nDatum;01.03.2024;;\nHöhe (mm);20;;\n;;;\nZeit (ms);Weg (µm);Kraft (mN);Bemerkung\n'+rows(lambda k, t, d, f: f'{1000*t:,.1f};{1000*d:,.1f};{1000*f:,.2f};\n'.replace(',','#').replace('.',',').replace('#','.')),'latin-1')
    w('stations.csv','Time (s);Station 1 Load (N);Station 1 Position (mm);Station 2 Load (N);Station 2 Position (mm)\n'+rows(lambda k, t, d, f: f'{t:.2f};{f:.4f};{d:.4f};{2*f:.4f};{d:.4f}\n'))
    w('sidenames.csv','Specimen 1;;;Specimen 2;;;Specimen 3;;\nZeit [s];Kraft [N];Weg [mm];Zeit [s];Kraft [N];Weg [mm];Zeit [s];Kraft [N];Weg [mm]\n'+rows(lambda k, t, d, f: c(';'.join((f'{t:.2f};{s*f:.4f};{d:.4f}' if k<n else ';;') for s,n in ((1,50),(2,71),(3,60)))+'\n')))
    w('galdabini.csv','Prova n.;4\nAltezza provino [mm];20,00\nDiametro [mm];10,00\nTempo[s];Carico[N];Corsa[mm]\n'+rows(lambda k, t, d, f: c(f'{t:.2f};{f:.4f};{d:.4f}\n')))
    w('deben.csv','Date,01/03/2024\nSample,gel\nGauge length,20 mm\nTime,Force,Elongation,Position\nsecs,N,mm,mm\n'+rows(lambda k, t, d, f: f'{t:.2f},{-f:.4f},{-d:.4f},{20-d:.4f}\n'))
    w('cetr.txt','Fz(N),Z(mm),T(s),Fx(N),COF\n'+rows(lambda k, t, d, f: f'{-f:.4f},{d+3:.4f},{t:.2f},{0.01*(1 if int(t*10)%2 else -1)},0.1\n'))
    w('arduino.log','10:15:00.100 -> Force tester v1\n10:15:00.120 -> time_ms,pos_um,force_mN\n'+rows(lambda k, t, d, f: f'10:15:{t+1:06.3f} -> {1000*t:.0f},{1000*d:.0f},{1000*f:.1f}\n'))


# ---- what they must become: N and mm of the file's 1, how many specimens; size where the file tells it ----
SCALE = {'jpk': (1e-3, 1e-8), 'hysitron': (1e-3, 1e-4), 'femtotools': (1e-3, 1e-6), 'piuma': (1e-3, 1e-6), 'ap_indent': (1e-3, 1e-3), 'g200': (1e-3, 1e-3)}
RUNS = {'trapezium2': (71, 60), 'exponent_arc': (71, 71), 'vectorpro': (71, 71), 'emperor': (71, 71), 'pasco': (71, 71), 'sidenames': (50, 71, 60), 'stations': (71, 71)}
SIZES = {'zwick_fr': (20, 5), 'zwick_iii': (20, None), 'bluehill2': (20, 5), 'mts_testsuite': (20, None), 'trapezium1': (20, 5), 'nexygen': (20, None), 'univert': (20, None),
         'microsquisher': (20, None), 'rheocompass': (20, None), 'admet': (20, 5), 'horizon': (20, None), 'rsag2': (20, 5), 'kinexus': (20, None), 'haake': (20, None),
         'galdabini': (20, 5), 'seriesix': (20, None), 'excel_de': (20, None), 'deben': (20, None), 'trapezium2_01': (20, 5), 'trapezium2_02': (25, 6)}


def read(path):
    """The header's numbers and the rows."""
    with open(path) as f:
        lines = f.read().splitlines()
    keys = dict(line[2:].split(': ', 1) for line in lines if line.startswith('# ') and ': ' in line)
    return keys, [[float(x) for x in line.split(',')[:3]] for line in lines if line[0] in '-0123456789']


def compare_run(name, run, path, group, n):
    keys, got = read(path)
    mm, newton = SCALE.get(name, (1, 1))
    bad = [] if len(got) == n else ['%d rows, not %d' % (len(got), n)]
    for t, depth, force in got:
        _, d, f = press(round(10 * (t - got[0][0]), 6)) if name != 'jpk' else jpk_press(t)
        if abs(depth - d * mm) > 5e-6 * mm or abs(force - f * newton * group) > 6e-5 * newton * group:
            bad.append('at %g s %g mm, %g N, not %g, %g' % (t, depth, force, d * mm, f * newton * group))
    height, radius = SIZES.get(run, (None, None))
    for key, want in (('height', height), ('radius', radius)):
        have = float(keys.get('specimen.%s_mm' % key, 'nan'))
        if want and not abs(have - want) < 1e-6 * want:
            bad.append('%s %g, not %g' % (key, have, want))
    return ['%s: %s' % (run, line) for line in bad[:2]]


def compare(out):
    bad = []
    for file in sorted(os.listdir(out)):
        name = os.path.splitext(file)[0]
        wanted = RUNS.get(name, (301,) if name == 'jpk' else (71,))
        runs = sorted(run for run in os.listdir(os.path.join(out, file)) if run.endswith('.csv'))
        if len(runs) != len(wanted):
            bad.append('%s: %d runs, not %d' % (file, len(runs), len(wanted)))
            continue
        for k, run in enumerate(runs):
            bad += compare_run(name, run[:-4], os.path.join(out, file, run), k + 1, wanted[k])
    print('\n'.join(bad))
    return bool(bad)


if __name__ == '__main__':
    if sys.argv[1] == '--compare':
        sys.exit(compare(sys.argv[2]))
    os.makedirs(sys.argv[1], exist_ok=True)
    write_all()
